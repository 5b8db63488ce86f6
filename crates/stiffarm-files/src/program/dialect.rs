//! What is known of a robot's language: one value per language.

use super::cursor::Cursor;
use super::flow::Procedures;
use super::reader::Reader;
use stiffarm::error::Result;
use stiffarm::model::pose::Convention;
use stiffarm::model::robot::Controller;

/// A language: what it can hold, and how it is written and read.
pub struct Dialect {
    /// Its name on the command line.
    pub name: &'static str,
    /// Its name for people.
    pub title: &'static str,
    /// The maker whose controllers speak it; `None` for a table.
    pub controller: Option<Controller>,
    /// Fewest and most joints of a robot that it can move.
    pub axes: [usize; 2],
    /// What an axis is called, counted from 0 in the controller's order.
    pub axis_name: fn(usize) -> String,
    /// What a speed of 100 per cent is.
    pub speed_of: &'static str,
    /// Most decimals of an angle in degrees. Controllers hold single precision, seven digits.
    pub most_decimals: usize,
    /// Whether angles are encoder pulses, whose number per degree the user has to give.
    pub in_pulses: bool,
    /// How the tool is named.
    pub tool: Tool,
    /// Most characters of a program's name.
    pub longest_name: usize,
    /// Whether its names have capital letters only.
    pub upper_case: bool,
    /// Words that are no names, in any case, with spaces between them.
    pub reserved: &'static str,
    /// How its lines are written and read; `None` for a table.
    pub syntax: Option<Syntax>,
}

impl Dialect {
    /// What most languages have in common.
    pub const USUAL: Dialect = Dialect {
        name: "",
        title: "",
        controller: None,
        axes: [1, usize::MAX],
        axis_name: |axis| format!("J{}", axis + 1),
        speed_of: "the largest speed of each axis",
        most_decimals: 4,
        in_pulses: false,
        tool: Tool::OnController,
        longest_name: 32,
        upper_case: false,
        reserved: "",
        syntax: None,
    };
}

/// How a language names the tool.
#[derive(Clone, Copy)]
pub enum Tool {
    /// It is set on the controller.
    OnController,
    /// A number up to the first; the second where none is given.
    Number(u32, Option<&'static str>),
    /// A name; this one where none is given.
    Name(&'static str),
}

impl Tool {
    /// The tool where none is given.
    pub fn default(self) -> Option<&'static str> {
        match self {
            Tool::OnController => None,
            Tool::Number(_, default) => default,
            Tool::Name(default) => Some(default),
        }
    }
}

/// The lines of a language.
pub struct Syntax {
    /// Extensions of its files and what stands in them; see [`super::writer`]. In the first are the moves.
    pub files: &'static [(&'static str, &'static str)],
    /// Whether the names of its files have small letters.
    pub small_file_names: bool,
    /// CR LF where the controller or its tools run on Windows.
    pub line_end: &'static str,
    /// Most characters of a comment in the header.
    pub comment_width: usize,
    /// Most characters of a posture's name in a comment.
    pub name_width: usize,
    /// The label of a point, counted from 1.
    pub label: fn(usize) -> String,
    /// The comment that names a move.
    pub marker: fn(&str) -> String,
    /// Sets the speed in per cent; `None` where each move has its own.
    pub speed: Option<fn(u8) -> String>,
    /// The move.
    pub movement: fn(&Target) -> Vec<String>,
    /// The point that it goes to, where points stand apart.
    pub point: fn(&Target) -> Vec<String>,
    /// Shows a text and waits.
    pub wait: fn(&str) -> Vec<String>,
    /// Reads a line; false where it is none of those that are looked for.
    pub read: for<'a> fn(&mut Cursor<'a>, &mut Reader<'a>) -> Result<bool>,
    /// Its move to joint angles.
    pub joint_move: &'static str,
    /// Its other moves, which cannot be read.
    pub other_moves: &'static [&'static str],
    /// Words of lines that may change the way through the program.
    pub branches: &'static [&'static str],
    /// How its procedures stand; `None` where a file is one.
    pub procedures: Option<Procedures>,
    /// How the poses of its moves stand; `None` where they are not read.
    pub poses: Option<PoseForm>,
    /// What says that a point is not there; its label follows.
    pub missing_point: &'static str,
    /// Begins a comment.
    pub comment: &'static str,
    /// Whether comments fill lines, and end none.
    pub comments_fill_lines: bool,
    /// Stands around texts.
    pub quote: char,
    /// Whether lines begin with numbers.
    pub numbered: bool,
    /// How lines begin that the controller renews, in small letters without spaces.
    pub notes: &'static [&'static str],
    /// One of these words stands in each line with the angles of a posture.
    pub angle_words: &'static [&'static str],
    /// Where in that line.
    pub angles: Angles,
}

impl Syntax {
    /// What most languages have in common.
    pub const USUAL: Syntax = Syntax {
        files: &[],
        small_file_names: false,
        line_end: "\r\n",
        comment_width: 76,
        name_width: 60,
        label: |_| String::new(),
        marker: str::to_string,
        speed: None,
        movement: |_| Vec::new(),
        point: |_| Vec::new(),
        wait: |_| Vec::new(),
        read: |_, _| Ok(false),
        joint_move: "",
        other_moves: &[],
        branches: &[],
        procedures: None,
        poses: None,
        missing_point: "",
        comment: "",
        comments_fill_lines: false,
        quote: '"',
        numbered: false,
        notes: &[],
        angle_words: &[],
        angles: Angles::Named(1),
    };
}

/// How a language gives poses.
#[derive(Debug, Clone, Copy)]
pub struct PoseForm {
    /// The orientation behind x, y, z.
    pub convention: Convention,
    /// Unit of lengths \[m\].
    pub unit: f64,
    /// Whether angles are degrees.
    pub degrees: bool,
    /// What stands before each number, for those that the line leaves out.
    pub before: &'static [&'static str],
    /// Fewest decimals of a length and of a number of the orientation that is written.
    pub decimals: [usize; 2],
    /// Whether poses are those in the base frame of the robot, not in a workpiece frame.
    pub in_base: bool,
    /// Names of the base of the controller and of the flange, in capital letters.
    pub null_frames: &'static [&'static str],
    /// Whether the point on the way of an arc says how the tool is turned there; else that follows from its ends.
    pub turns_on_the_way: bool,
    /// How a tool path is written; `None` where it is not.
    pub moves: Option<Moves>,
}

/// A program of linear moves.
#[derive(Debug, Clone, Copy)]
pub struct Moves {
    /// What stands in its file, as in [`Syntax::files`]; `{base}` is the base.
    pub template: &'static str,
    /// Tool and base where none are given.
    pub frames: [&'static str; 2],
    /// Most moves.
    pub most: usize,
    /// The move; the first with what is set before it.
    pub lines: fn(&LinearMove) -> Vec<String>,
    /// The point that it goes to, where points stand apart.
    pub point: fn(&LinearMove) -> Vec<String>,
}

/// Where a linear move goes.
pub struct LinearMove<'a> {
    /// Counted from 1; the first is a joint move.
    pub number: usize,
    /// x, y, z and the orientation.
    pub pose: Vec<String>,
    /// Angles \[deg\].
    pub angles: Vec<String>,
    /// How FANUC names the configuration.
    pub configuration: String,
    pub speed_mm_s: f64,
    pub tool: &'a str,
    pub base: &'a str,
}

impl LinearMove<'_> {
    /// Angles or numbers after their names.
    pub fn named(names: &[&str], values: &[String], between: &str) -> String {
        let pairs = names.iter().zip(values);
        let pairs: Vec<String> = pairs.map(|(name, value)| format!("{name}{between}{value}")).collect();
        pairs.join(",")
    }
}

/// Where the angles of a posture stand in a line.
#[derive(Clone, Copy)]
pub enum Angles {
    /// So many words and signs after the name of the axis.
    Named(usize),
    /// One after the other behind this sign.
    After(&'static str),
    /// One after the other behind this sign, which is the second part of the line.
    Second(&'static str),
}

/// Where a move goes.
pub struct Target<'a> {
    /// The label of the point.
    pub label: String,
    /// Degrees or pulses in the controller's order.
    pub values: Vec<String>,
    /// In per cent.
    pub speed_percent: u8,
    /// The tool.
    pub tool: &'a str,
}

impl Target<'_> {
    /// The angles after the names of their axes.
    pub fn named(&self, dialect: &Dialect, between: &str) -> Vec<String> {
        let values = self.values.iter().enumerate();
        values.map(|(axis, value)| format!("{}{between}{value}", (dialect.axis_name)(axis))).collect()
    }
}
