//! The table of words: what each does to where the tool is.
//!
//! ISO 6983-1:2009; LinuxCNC, *G-Codes*, *M-Codes* and its interpreter, 2.9; FANUC, *Series 30i Operator's Manual*;
//! Siemens, *SINUMERIK 840D sl, Programming Guide*; Haas, *Mill Operator's Manual*. Where controls mean different
//! things by one word, the row is the one that loses nothing.

use super::effect::Effect::{self, *};
use super::effect::{Drill, Feeds, Mode, Retract, Row};

const fn row(words: &'static str, effect: Effect, does: &'static str) -> Row {
    Row { words, effect, does }
}

const fn drill(pecks: bool, dwells: bool, out: Retract) -> Effect {
    Effect::Moves(Mode::Drill(Drill { pecks, dwells, out }))
}

/// The table.
pub const ROWS: &[Row] = &[
    row("G0", Moves(Mode::Rapid), "leads rapidly to the point"),
    row("G1", Moves(Mode::Feed), "leads straight to the point at feed"),
    row("G2", Moves(Mode::Arc { is_left: false }), "leads on a clockwise arc or helix"),
    row("G3", Moves(Mode::Arc { is_left: true }), "leads on a counter-clockwise arc or helix"),
    row("G81", drill(false, false, Retract::Rapid), "drills"),
    row("G82", drill(false, true, Retract::Rapid), "drills and waits at the bottom"),
    row("G83", drill(true, false, Retract::Rapid), "drills in steps of Q, out of the hole after each"),
    row("G85", drill(false, false, Retract::FeedToR), "bores, out at feed"),
    row("G89", drill(false, true, Retract::Feed), "bores, waits at the bottom, out at feed"),
    row("G98", BackToStart(true), "lets cycles come back to where they began"),
    row("G99", BackToStart(false), "lets cycles come back to R"),
    row("G80", EndsCycle, "ends a cycle"),
    row("G17", Plane(2), "puts arcs into XY"),
    row("G18", Plane(1), "puts arcs into ZX"),
    row("G19", Plane(0), "puts arcs into YZ"),
    row("G20 G70 G700", Inches(true), "says that lengths are inches"),
    row("G21 G71 G710", Inches(false), "says that lengths are millimetres"),
    row("G90", Steps(false), "says that points are stated"),
    row("G91", Steps(true), "says that points are stated as steps"),
    row("G90.1", CentresAbsolute(true), "says that I, J, K are points"),
    row("G91.1", CentresAbsolute(false), "says that I, J, K are steps from the start of the arc"),
    row("G93", Effect::Feeds(Feeds::Inverse), "says that F is the inverse of a time"),
    row("G94", Effect::Feeds(Feeds::Minute), "says that F is a feed per minute"),
    row("G95", Effect::Feeds(Feeds::Turn), "says that F is a feed per turn"),
    row("G96", CuttingSpeed(true), "says that S is the speed of the cutting edge"),
    row("G97", CuttingSpeed(false), "says that S is the speed of the spindle"),
    row("G43.5", Vectors(true), "says that I, J, K are the tool axis"),
    row("G43 G43.4 G49", Vectors(false), "takes or ends a tool's length, which is the control's"),
    row(
        "G54-G59 G59.1 G59.2 G59.3 G500 G505-G599",
        Offset(None),
        "takes a work offset: that of the cell's workpiece frame",
    ),
    row("G54.1 G154", Offset(Some(b'P')), "takes the work offset P"),
    row("G15", Offset(Some(b'H')), "takes the work offset H (Okuma), or ends polar coordinates"),
    row("G53 G153", Machine, "leads to coordinates of the machine: its axes are unknown then"),
    row("G27 G28 G30 G75", Home, "leads to a place of the machine: its axes, or all, are unknown then"),
    row(
        "G73 G74 G76 G84 G84.2 G84.3 G86 G87 G88",
        Moves(Mode::Unfollowed),
        "is a cycle that is not followed: X, Y and Z are unknown then",
    ),
    row(
        "CYCLE HOLES POCKET SLOT LONGHOLE",
        Home,
        "drills or mills in a way of the control (Siemens): X, Y and Z are unknown then",
    ),
    row("TURN", Turns, "adds whole turns to an arc"),
    row("G4", Dwells, "waits"),
    row("G22 G25 G26", TakesAxes, "sets limits"),
    row("M0 M1 M60", Stops, "stops behind the move of its block"),
    row("M2 M30 M99 M17 RET", Ends, "ends the program"),
    row(
        "G8 G9 G11 G13.1 G23 G40 G40.1 G44 G50.1 G60 G61 G61.1 G62 G63 G64 G67 G69 G69.1 G100 G103 G160 G187 G234 G255 \
         G269 G450 G451 G601 G602 G603 G641-G645",
        Quiet,
        "changes no point",
    ),
    row(
        "TRAORI TRAFOOF MSG STOPRE FFWON FFWOF SOFT BRISK DRIVE COMPCAD COMPCURV COMPON COMPOF COMPSURF ORIWKS ORIMKS \
         ORIAXES ORIVECT CFTCP CFC CFIN CDON CDOF NORM KONT DIAMOF UPATH SPATH CYCLE832 SPOS SPOSA LIMS LEAD TILT OTOL \
         CTOL FB FRC FRCM FZ ACC",
        Quiet,
        "changes no point",
    ),
    row("DEF PROC EXTERN", Declares, "declares: the rest of its block is its own"),
    row("G5 G5.1", Alone, "looks ahead; beside axis words it is a spline"),
    row("G28.1 G30.1", Alone, "keeps where the machine is"),
    row("G50 G150", Alone, "ends scaling or turning; beside axis words it sets coordinates or mills a pocket"),
    row("G52 G92", Alone, "beside axis words moves the frame of the points"),
    row("G92.1 G92.2", Resets, "takes back a frame that G92 has moved"),
    row(
        "TRANS ATRANS ROT AROT SCALE ASCALE MIRROR AMIRROR TOFRAME CYCLE800",
        Resets,
        "moves, turns or scales the frame of the points",
    ),
    row("G7 DIAMON DIAM90", Refused, "says that X is a diameter"),
    row("G7.1 G107 TRACYL", Refused, "unrolls the path from a cylinder"),
    row("G10 G10.6", Refused, "sets offsets or parameters"),
    row("G12 G13 G47", Refused, "mills a figure that is not stated as points"),
    row("G12.1 G16 G110 G111 G112 AP RP TRANSMIT", Refused, "gives polar coordinates"),
    row("G29", Refused, "leads over a point that another block has stated"),
    row("G31 G31.1 G31.2 G31.3 G31.8 G36 G37 G38.2 G38.3 G38.4 G38.5 MEAS MEAW", Refused, "ends where a probe touches"),
    row("G32 G33 G33.1 G33.2 G33.3 G34 G35", Refused, "cuts a thread, or taps and comes back"),
    row(
        "G39 G41 G41.1 G41.2 G41.3 G41.4 G41.5 G41.6 G42 G42.1 G42.2 G42.3 G42.4 G42.5 G42.6 OFFN",
        Refused,
        "offsets the path by a radius of the tool",
    ),
    row("G43.1 G43.2 G43.3 G43.7 G43.8 G43.9 G45 G46 G48 TOFFL TOFF", Refused, "adds a length to where the points lie"),
    row("G51 G51.1 G101", Refused, "scales or mirrors the path"),
    row(
        "G53.1 G53.2 G53.6 G54.2 G54.3 G54.4 G68 G68.1 G68.2 G68.3 G68.4 G72.1 G72.2 G92.3 G254 G268 ROTS AROTS CROT \
         CTRANS CSCALE CMIRROR TOROT TOROTX TOROTY PAROT TCARR",
        Refused,
        "moves or turns the frame of the points",
    ),
    row("G5.2 G5.3 G6 G6.1 G6.2 BSPLINE ASPLINE CSPLINE POLY", Refused, "leads on a spline"),
    row("CIP CT AR ANG ANG1 ANG2", Refused, "leads on an arc that is stated in another way"),
    row("CHF CHR RND RNDM", Refused, "rounds corners"),
    row("G147 G148 G247 G248 G347 G348", Refused, "leads softly to the contour, on a way of the control"),
    row("G17.1 G18.1 G19.1 G290 G291 SUPA", Refused, "changes what axis words mean"),
    row("G65 G65.1 G66 G66.1 M97 M98 M198 CALL PCALL EXTCALL MCALL SUB ENDSUB", Refused, "calls a subprogram"),
    row(
        "IF ELSE ENDIF GOTO GOTOF GOTOB GOTOC GOTOS CASE WHILE ENDWHILE FOR ENDFOR LOOP ENDLOOP REPEAT REPEATB UNTIL \
         DO",
        Refused,
        "lets the control decide where to go on",
    ),
    row("M72 M73", Refused, "brings back modes that were kept"),
];
