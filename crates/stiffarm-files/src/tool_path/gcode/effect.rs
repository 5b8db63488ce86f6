//! What a word of G-code can do to where the tool is.

/// How a block leads to its point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Mode {
    Rapid,
    Feed,
    /// Counter-clockwise or clockwise.
    Arc {
        is_left: bool,
    },
    Drill(Drill),
    /// A cycle that is not followed.
    Unfollowed,
}

/// How a drilling cycle goes into the hole and out of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Drill {
    /// In steps of Q, out of the hole after each.
    pub pecks: bool,
    /// Stays at the bottom for the time P.
    pub dwells: bool,
    pub out: Retract,
}

/// How it comes out of the hole.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Retract {
    Rapid,
    /// At feed to R, from there rapidly.
    FeedToR,
    Feed,
}

/// What F stands for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Feeds {
    /// The inverse of the move's time.
    Inverse,
    Minute,
    Turn,
}

/// What a word does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Effect {
    Moves(Mode),
    /// Arcs lie across this axis.
    Plane(usize),
    Inches(bool),
    Steps(bool),
    CentresAbsolute(bool),
    Feeds(Feeds),
    CuttingSpeed(bool),
    /// I, J, K of straight moves are the tool axis.
    Vectors(bool),
    /// Cycles come back to where they began, or to R only.
    BackToStart(bool),
    EndsCycle,
    /// Another frame of the points; its number is the value of this letter, where it has one.
    Offset(Option<u8>),
    /// The axes of the block go to the machine's coordinates.
    Machine,
    /// The axes of the block, or all, go to a place of the machine.
    Home,
    /// An arc has so many more turns.
    Turns,
    /// Waits: for X where no P says how long.
    Dwells,
    /// The axis words of the block are its own, and no point.
    TakesAxes,
    Quiet,
    /// The rest of the block is its own.
    Declares,
    /// Changes nothing in a block without axis words; beside them it is refused.
    Alone,
    /// Takes back what this program cannot have set, in its head or without values.
    Resets,
    /// The program is over.
    Ends,
    /// Stops behind the move of its block.
    Stops,
    Refused,
}

/// Words with the same effect.
#[derive(Debug)]
pub struct Row {
    /// With blanks between them; `G505-G599` are all from the first to the last.
    pub words: &'static str,
    pub effect: Effect,
    /// What they do, as the rest of a sentence that begins with the word.
    pub does: &'static str,
}
