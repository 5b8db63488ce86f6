//! FANUC TP programs have sections in order, lines numbered and counted, points in joint representation.

use super::grammar::{Checked, Parsed, Tokens, holds, lines, name, only};
use stiffarm_files::program::ProgramFile;

pub fn check(files: &[ProgramFile], joints: usize) -> Checked {
    let file = only(files)?;
    let lines = lines(file, "\r\n", 80)?;
    let program = lines[0].strip_prefix("/PROG  ").ok_or("/PROG")?;
    name(program, 36)?;
    holds(program == program.to_ascii_uppercase(), "capitals")?;
    holds(file.name == format!("{}.ls", program.to_ascii_lowercase()), "file name")?;
    let at = |section: &str| {
        let mut places = lines.iter().enumerate().filter(|(_, line)| **line == section);
        match (places.next(), places.next()) {
            (Some((at, _)), None) => Ok(at),
            _ => Err(format!("{section} once")),
        }
    };
    let (body, points, end) = (at("/MN")?, at("/POS")?, at("/END")?);
    holds(at("/ATTR")? == 1 && end + 1 == lines.len() && body < points, "order")?;
    let count = attributes(&lines[2..body])?;
    let statements = &lines[body + 1..points];
    holds(count == statements.len(), "LINE_COUNT")?;
    let (targets, tool) = positions(&lines[points + 1..end], joints)?;
    let mut parsed = Parsed::default();
    let mut said: Vec<&str> = Vec::new();
    let (mut frame_set, mut tool_set) = (false, false);
    for (i, line) in statements.iter().enumerate() {
        let rest = line.strip_prefix(&format!("{:4}:", i + 1)).ok_or("line number")?;
        let rest = rest.strip_suffix(" ;").ok_or_else(|| format!("end: {line}"))?;
        if let Some(remark) = rest.strip_prefix("  !") {
            holds((1..=32).contains(&remark.len()), format!("remark {remark}"))?;
        } else if let Some(message) = rest.strip_prefix("  MESSAGE[") {
            let message = message.strip_suffix(']').ok_or("]")?;
            let plain = !message.contains(['[', ']', ';', '!']);
            holds(plain && (1..=24).contains(&message.len()), message)?;
            said.push(message);
        } else if rest == "  PAUSE" {
            holds(!said.is_empty(), "PAUSE without a message")?;
            parsed.waits.push(said.join(" "));
            said.clear();
        } else if rest == "  UFRAME_NUM=0" {
            frame_set = true;
        } else if rest == format!("  UTOOL_NUM={tool}") {
            tool_set = true;
        } else {
            holds(frame_set && tool_set && said.is_empty(), "frames before moves")?;
            let mut tokens = Tokens::of(rest, '"')?;
            tokens.word("J")?;
            tokens.word("P")?;
            tokens.signs("[")?;
            let number = tokens.number(0, 0)? as usize;
            tokens.signs("]")?;
            let speed = tokens.number(0, 0)?;
            tokens.signs("%")?;
            tokens.word("FINE")?;
            tokens.end()?;
            holds(number == parsed.moves.len() + 1, "order of points")?;
            let target = targets.get(number - 1).ok_or("a point that is not there")?;
            holds((1.0..=100.0).contains(&speed), "speed")?;
            parsed.moves.push((target.clone(), speed));
        }
    }
    holds(targets.len() == parsed.moves.len(), "a point that is not used")?;
    Ok(parsed)
}

/// The attributes in the controller's order; gives LINE_COUNT.
fn attributes(lines: &[&str]) -> Checked<usize> {
    let keys = [
        "OWNER",
        "COMMENT",
        "PROG_SIZE",
        "CREATE",
        "MODIFIED",
        "FILE_NAME",
        "VERSION",
        "LINE_COUNT",
        "MEMORY_SIZE",
        "PROTECT",
        "TCD:  STACK_SIZE",
        "      TASK_PRIORITY",
        "      TIME_SLICE",
        "      BUSY_LAMP_OFF",
        "      ABORT_REQUEST",
        "      PAUSE_REQUEST",
        "DEFAULT_GROUP",
        "CONTROL_CODE",
    ];
    holds(lines.len() == keys.len(), "attributes")?;
    let mut count = None;
    for (i, (line, key)) in lines.iter().zip(keys).enumerate() {
        let end = if (10..15).contains(&i) { ',' } else { ';' };
        let line = line.strip_suffix(end).ok_or_else(|| format!("end of {line}"))?;
        let (attribute, value) = line.split_once('=').ok_or("=")?;
        holds(attribute.trim_end() == key, key)?;
        let value = value.trim();
        let number = value.parse::<usize>();
        let sound = match key {
            "OWNER" => value == "MNEDITOR",
            "COMMENT" => value.len() <= 18 && value.len() > 2 && value.starts_with('"') && value.ends_with('"'),
            "CREATE" | "MODIFIED" => value == "DATE 00-01-01  TIME 00:00:00",
            "FILE_NAME" => value.is_empty(),
            "PROTECT" => value == "READ_WRITE",
            "DEFAULT_GROUP" => value == "1,*,*,*,*",
            "CONTROL_CODE" => value == "00000000 00000000",
            "LINE_COUNT" => {
                count = number.clone().ok();
                number.is_ok()
            }
            _ => number.is_ok(),
        };
        holds(sound, format!("{key} {value}"))?;
    }
    count.ok_or_else(|| "LINE_COUNT".to_string())
}

/// The points in order, and the tool that all have.
fn positions(lines: &[&str], joints: usize) -> Checked<(Vec<Vec<f64>>, String)> {
    let rows = joints.div_ceil(3);
    let each = 4 + rows;
    holds(lines.len().is_multiple_of(each), "lines of the points")?;
    let mut tool: Option<String> = None;
    let mut points = Vec::new();
    for (number, point) in lines.chunks(each).enumerate() {
        holds(point[0] == format!("P[{}]{{", number + 1), point[0])?;
        holds(point[1] == "   GP1:" && point[each - 1] == "};", "GP1")?;
        let frames = point[2].strip_prefix("\tUF : 0, UT : ").ok_or("UF")?;
        let used = frames.strip_suffix(',').ok_or("UT")?.to_string();
        holds(*tool.get_or_insert(used.clone()) == used, "tools")?;
        let mut values = Vec::new();
        for (row, line) in point[3..each - 1].iter().enumerate() {
            let line = if row + 1 < rows { line.strip_suffix(',').ok_or("comma")? } else { line };
            let fields: Vec<&str> = line.strip_prefix('\t').ok_or("tab")?.split(",\t").collect();
            for field in fields {
                let joint = values.len();
                let axis = match joint {
                    0..6 => format!("J{}", joint + 1),
                    _ => format!("E{}", joint - 5),
                };
                let mut tokens = Tokens::of(field, '"')?;
                tokens.word(&axis)?;
                tokens.signs("=")?;
                values.push(tokens.number(2, 3)?);
                tokens.word("deg")?;
                tokens.end()?;
            }
        }
        holds(values.len() == joints, "joints of a point")?;
        points.push(values);
    }
    Ok((points, tool.unwrap_or_default()))
}
