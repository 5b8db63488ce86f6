//! Times as clocks and spreadsheets show them, as seconds since the first reading.

use crate::table::grid::{Field, Heading, Style, Table};
use crate::table::naming::DATE;
use stiffarm::error::{Code, Error, Result};
use stiffarm::model::cell::DateOrder;
use stiffarm::units::rounded;

/// What a cell of a workbook that holds a date or a time begins with.
pub(in crate::table) const DATED: &str = "the time ";

/// Seconds of a day.
const DAY: f64 = 86400.0;

/// A clock that goes back by more has passed midnight \[s\].
const MIDNIGHT: f64 = 43200.0;

/// The heading of days since some date, as spreadsheets count them.
const DAYS: &str = "time_d";

const HINT: &str = "times are read as 2026-11-23T14:05:12, 23.11.2026 14:05:12, 11/23/2026 2:05:12 PM, 14:05:12 or \
                    seconds; ignore in [columns] of the cell file leaves the column out";

/// Turns the column of times into seconds since the first of them, where it is not seconds
/// already; a column `date` beside it belongs to it.
pub(super) fn to_seconds(table: &mut Table<'_>, dates: Option<DateOrder>) -> Result<()> {
    let find = |wanted: &dyn Fn(&Heading) -> bool| {
        let mut headings = table.headings.iter();
        headings.position(|heading| !heading.ignored && wanted(heading))
    };
    let Some(at) = find(&|heading| heading.name.starts_with("time_")) else {
        return Ok(());
    };
    let date = find(&|heading| heading.name == DATE);
    let in_days = table.headings[at].name == DAYS;
    let plain = |field: &Field| field.text.is_empty() || (!field.other && field.text.parse::<f64>().is_ok());
    let all_plain = {
        let mut fields = table.rows.below().filter_map(|row| row.fields.get(at));
        fields.all(plain)
    };
    if !in_days && date.is_none() && all_plain {
        return Ok(());
    }
    let stamps = stamps(table, at, date, in_days)?;
    if !in_days && date.is_none() && stamps.iter().all(|s| matches!(s.1, Clock::Number(_))) {
        return Ok(());
    }
    let seconds = seconds(table, at, &stamps, dates)?;
    let first = seconds.first().copied().unwrap_or(0.0);
    for ((row, _), value) in stamps.iter().zip(&seconds) {
        let field = &mut table.rows.fields_mut(*row)[at];
        // To a microsecond: days in a double know no more.
        field.text = rounded(value - first, 6).to_string().into();
        field.other = false;
    }
    table.headings[at].name = "time_s".to_string();
    if let Some(date) = date {
        table.headings[date].ignored = true;
    }
    Ok(())
}

/// What a field shows.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Clock {
    /// A number alone.
    Number(f64),
    /// A time without a date \[s\].
    Time(f64),
    /// A date whose parts are known, and a time: day number and seconds, UTC where `zoned`.
    Date { day: i64, time: f64, zoned: bool },
    /// Two numbers that are day and month in some order, the year, the time.
    Either { parts: [u32; 2], year: i64, time: f64 },
}

/// The fields of the column that hold something, with the numbers of their rows.
fn stamps(table: &Table<'_>, at: usize, date: Option<usize>, in_days: bool) -> Result<Vec<(usize, Clock)>> {
    let mut out = Vec::new();
    for number in 1..table.rows.len() {
        let row = table.rows.at(number);
        let Some(field) = row.fields.get(at).filter(|field| !field.text.is_empty()) else {
            continue;
        };
        // Some write a text mark of Excel before a date.
        let text = field.text.trim_start_matches(DATED).trim_start_matches('\'');
        let joined = date.and_then(|date| row.fields.get(date)).map(|day| {
            let day = day.text.trim_start_matches(DATED);
            // A workbook shows midnight behind a date, and the beginning of its count before a time.
            let day = day.split(' ').next().unwrap_or_default();
            let time = text.rsplit_once(' ').filter(|(day, _)| day.contains('-'));
            format!("{day} {}", time.map_or(text, |(_, time)| time))
        });
        let text = joined.as_deref().unwrap_or(text);
        let decimal = match table.style {
            Style::Others => text.replacen(',', ".", 1),
            _ => text.to_string(),
        };
        let clock = match decimal.parse::<f64>() {
            Ok(value) if value.is_finite() && in_days => Some(Clock::Number(value * DAY)),
            Ok(value) if value.is_finite() => Some(Clock::Number(value)),
            _ => clock(text),
        };
        let Some(clock) = clock else {
            let message = format!("\"{text}\" is neither a number nor a time.");
            return Err(table.error(&row, at, Code::TableRow, message).hint(HINT));
        };
        out.push((number, clock));
    }
    Ok(out)
}

/// The stamps as seconds of one clock.
fn seconds(table: &Table<'_>, at: usize, stamps: &[(usize, Clock)], dates: Option<DateOrder>) -> Result<Vec<f64>> {
    let fault = |row: usize, message: &str| -> Error { table.error(&table.rows.at(row), at, Code::TableRow, message) };
    let kind = |clock: &Clock| match clock {
        Clock::Number(_) => 0,
        Clock::Time(_) => 1,
        Clock::Date { zoned: true, .. } => 2,
        Clock::Date { .. } | Clock::Either { .. } => 3,
    };
    let other = stamps.windows(2).find(|pair| kind(&pair[0].1) != kind(&pair[1].1));
    if let Some([_, (row, _)]) = other {
        let message =
            "This time is not written like the one before: number, time of day, date, or date with time zone.";
        return Err(fault(*row, message).hint("give the whole column in one form"));
    }
    let order = match dates {
        Some(order) => Some(order),
        None => stated_order(stamps).map_err(|row| {
            let message = "Day and month stand in another order than before.";
            fault(row, message).hint("give the whole column in one form")
        })?,
    };
    let by = |order: DateOrder| -> Result<Vec<f64>> {
        let each = stamps.iter().map(|(row, clock)| {
            value(clock, order).ok_or_else(|| {
                fault(*row, "There is no such day.")
                    .hint("dates in [columns] of the cell file is \"day-first\" or \"month-first\"")
            })
        });
        each.collect()
    };
    let Some(order) = order else {
        let both = [by(DateOrder::DayFirst)?, by(DateOrder::MonthFirst)?];
        let [day, month] = both.each_ref().map(|all| all.iter().map(|v| v - all[0]));
        if day.eq(month) {
            // All on one day: the order does not matter.
            return Ok(both.into_iter().next().unwrap_or_default());
        }
        let row = stamps.iter().find(|(_, clock)| matches!(clock, Clock::Either { .. }));
        let row = row.map_or(0, |(row, _)| *row);
        let message = "Nothing in the column tells whether day or month comes first.";
        return Err(fault(row, message)
            .hint("write dates = \"day-first\" or dates = \"month-first\" into [columns] of the cell file"));
    };
    let values = by(order)?;
    let back = stamps.iter().zip(&values).zip(values.iter().skip(1)).zip(stamps.iter().skip(1));
    for ((((_, clock), before), after), (row, _)) in back {
        if matches!(clock, Clock::Time(_)) && before - after > MIDNIGHT {
            let message = "The clock goes back: times without a date cannot pass midnight.";
            return Err(fault(*row, message).hint("export the date with the time"));
        }
    }
    Ok(values)
}

/// The order of day and month, where a number above 12 tells it or there is nothing to tell; the
/// error is the row that says otherwise.
fn stated_order(stamps: &[(usize, Clock)]) -> std::result::Result<Option<DateOrder>, usize> {
    let mut order = None;
    let mut open = false;
    for (row, clock) in stamps {
        let Clock::Either { parts, .. } = clock else {
            continue;
        };
        let date_order = match (parts[0], parts[1]) {
            (13.., _) => DateOrder::DayFirst,
            (_, 13..) => DateOrder::MonthFirst,
            _ => {
                open = true;
                continue;
            }
        };
        if order.is_some_and(|before| before != date_order) {
            return Err(*row);
        }
        order = Some(date_order);
    }
    Ok(order.or((!open).then_some(DateOrder::DayFirst)))
}

fn value(clock: &Clock, order: DateOrder) -> Option<f64> {
    match *clock {
        Clock::Number(seconds) | Clock::Time(seconds) => Some(seconds),
        Clock::Date { day, time, .. } => Some(day as f64 * DAY + time),
        Clock::Either { parts, year, time } => {
            let [day, month] = match order {
                DateOrder::DayFirst => parts,
                DateOrder::MonthFirst => [parts[1], parts[0]],
            };
            Some(day_number(year, month, day)? as f64 * DAY + time)
        }
    }
}

/// Reads a date with a time, or a time alone.
fn clock(text: &str) -> Option<Clock> {
    let text = text.trim();
    let (date, time) = match text.split_once(['T', ' ']) {
        Some((date, time)) if date.contains(['-', '.', '/']) && !date.contains(':') => {
            (date.trim_end_matches(','), time.trim())
        }
        _ if text.contains(':') => return Some(Clock::Time(time_of_day(text)?)),
        _ => (text, ""),
    };
    let (time, zone) = zone(time)?;
    let time = match time {
        "" => 0.0,
        time => time_of_day(time)?,
    } - zone.unwrap_or(0.0);
    let sign = date.find(['-', '.', '/'])?;
    let sign = date[sign..].chars().next()?;
    let parts: Vec<u32> = date.split(sign).map(|part| part.parse().ok()).collect::<Option<_>>()?;
    let [a, b, c] = parts[..] else {
        return None;
    };
    let zoned = zone.is_some();
    if date.find(sign) == Some(4) {
        let day = day_number(i64::from(a), b, c)?;
        return Some(Clock::Date { day, time, zoned });
    }
    let year = i64::from(c) + if c < 100 { 2000 } else { 0 };
    match sign {
        // Dates with points have the day first wherever they are used.
        '.' => Some(Clock::Date { day: day_number(year, b, a)?, time, zoned }),
        _ => {
            day_number(year, a, b).or_else(|| day_number(year, b, a))?;
            Some(Clock::Either { parts: [a, b], year, time })
        }
    }
}

/// A time, and how far the zone behind it is ahead of UTC \[s\].
fn zone(text: &str) -> Option<(&str, Option<f64>)> {
    if let Some(time) = text.strip_suffix(['Z', 'z']) {
        return Some((time.trim(), Some(0.0)));
    }
    let Some(at) = text.rfind(['+', '-']).filter(|at| *at > 0) else {
        return Some((text, None));
    };
    let (time, zone) = text.split_at(at);
    let digits: String = zone[1..].chars().filter(|c| *c != ':').collect();
    let (hours, minutes) = match digits.len() {
        2 => (digits.parse::<f64>().ok()?, 0.0),
        4 => (digits[..2].parse().ok()?, digits.get(2..)?.parse().ok()?),
        _ => return None,
    };
    let ahead: f64 = hours * 3600.0 + minutes * 60.0;
    let sign = if zone.starts_with('-') { -1.0 } else { 1.0 };
    Some((time.trim(), Some(sign * ahead)))
}

/// `14:05`, `14:05:12.3`, `2:05:12 PM` \[s\].
fn time_of_day(text: &str) -> Option<f64> {
    let lower = text.trim().to_lowercase().replace("a.m.", "am").replace("p.m.", "pm");
    let half = [("am", 0.0), ("pm", 12.0)].iter().find_map(|(word, hours)| {
        let time = lower.strip_suffix(word)?;
        Some((time.trim().to_string(), *hours))
    });
    let (time, afternoon) = match half {
        Some((time, hours)) => (time, Some(hours)),
        None => (lower, None),
    };
    let mut parts = time.split(':');
    let whole = |part: &str, below: f64| {
        let digits = !part.is_empty() && part.len() <= 2 && part.bytes().all(|b| b.is_ascii_digit());
        let value = part.parse::<f64>().ok().filter(|_| digits)?;
        (value < below).then_some(value)
    };
    let mut hours = whole(parts.next()?, 24.0)?;
    let minutes = whole(parts.next()?, 60.0)?;
    let seconds = match parts.next() {
        None => 0.0,
        Some(part) => {
            let part = part.replacen(',', ".", 1);
            let plain = part.starts_with(|c: char| c.is_ascii_digit());
            part.parse::<f64>().ok().filter(|s| plain && *s < 61.0)?
        }
    };
    if parts.next().is_some() {
        return None;
    }
    if let Some(afternoon) = afternoon {
        if !(1.0..=12.0).contains(&hours) {
            return None;
        }
        hours = hours % 12.0 + afternoon;
    }
    Some(hours * 3600.0 + minutes * 60.0 + seconds)
}

/// Days since 1970-01-01 in the Gregorian calendar; `None` for a day that is not there.
///
/// Counted in years that begin in March, whose months before the leap day have a fixed
/// length: E. G. Richards, "Calendars", in S. E. Urban, P. K. Seidelmann (eds.), Explanatory
/// Supplement to the Astronomical Almanac, 3rd ed., 2013, ch. 15.
fn day_number(year: i64, month: u32, day: u32) -> Option<i64> {
    let leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let length = match month {
        1 | 3 | 5 | 7 | 8 | 10 | 12 => 31,
        4 | 6 | 9 | 11 => 30,
        2 if leap => 29,
        2 => 28,
        _ => return None,
    };
    if !(1..=length).contains(&day) || !(1900..=2200).contains(&year) {
        return None;
    }
    let (month, day) = (i64::from(month), i64::from(day));
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let of_year = (153 * month + 2) / 5 + day - 1;
    Some(365 * year + year / 4 - year / 100 + year / 400 + of_year - 719_468)
}
