//! The file with tables of pitch errors: a line for each point, `axis position_mm error_um`, such as `z 120.5 -3.2`.
//!
//! X is a radius. The error is how far the slide is beyond the position, in plus. The points of an axis come in order
//! and evenly spaced; `#` begins a remark, and empty lines are none.

use interp_core::compensation::pitch::{POINTS, PitchError, PitchTable, UNIT_NM};
use interp_core::units::Length;
use measure::PerAxis;

/// The tables of a lathe.
pub type Tables = PerAxis<Option<PitchTable>>;

/// A point, with its line in the file.
#[derive(Copy, Clone, Debug)]
struct Point {
    line: usize,
    nm: i64,
    /// In units of a table.
    error: i16,
}

/// Reads the tables of a file called `name`.
///
/// # Errors
/// All that is wrong, each as lines of its own: place, cause, remedy.
pub fn read(name: &str, text: &str) -> Result<Tables, Vec<String>> {
    let (mut points, mut errors) = (PerAxis::<Vec<Point>>::default(), Vec::new());
    for (number, line) in (1..).zip(text.lines()) {
        let line = line.split('#').next().unwrap_or_default().trim();
        if line.is_empty() {
            continue;
        }
        match point(number, line) {
            Ok((true, point)) => points.x.push(point),
            Ok((false, point)) => points.z.push(point),
            Err(cause) => {
                errors.push(told(name, number, &cause, "write axis, position in mm and error in um: z 120.5 -3.2"))
            }
        }
    }
    if errors.is_empty() && points.x.is_empty() && points.z.is_empty() {
        errors.push(told(name, 1, "there is no point in it", "write a line for each point: z 120.5 -3.2"));
    }
    let x = table(name, 'x', &points.x, &mut errors);
    let z = table(name, 'z', &points.z, &mut errors);
    if errors.is_empty() { Ok(PerAxis { x, z }) } else { Err(errors) }
}

fn told(name: &str, line: usize, cause: &str, remedy: &str) -> String {
    format!("error: {name}:{line}: {cause}\n   = {remedy}")
}

/// A line: whether it is of X, and its point.
fn point(line: usize, text: &str) -> Result<(bool, Point), String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let [axis, position, error] = words.as_slice() else {
        return Err(format!("a point has three words, not {}", words.len()));
    };
    let x = match axis.to_ascii_lowercase().as_str() {
        "x" => true,
        "z" => false,
        _ => return Err(format!("there is no axis {axis}")),
    };
    let number = |text: &str, unit: f64, most: f64| match text.parse::<f64>() {
        Ok(value) if (value * unit).abs() <= most => Ok((value * unit).round()),
        Ok(_) => Err(format!("{text} is out of range")),
        Err(_) => Err(format!("{text} is no number")),
    };
    #[expect(clippy::cast_possible_truncation, reason = "within the range of a length, and of a table")]
    let (nm, error) = (
        number(position, 1e6, f64::from(Length::LIMIT_NM))? as i64,
        number(error, 1e3 / f64::from(UNIT_NM), f64::from(i16::MAX))? as i16,
    );
    Ok((x, Point { line, nm, error }))
}

/// The table of an axis, if it has one.
fn table(name: &str, axis: char, points: &[Point], errors: &mut Vec<String>) -> Option<PitchTable> {
    let (first, last) = (points.first()?, points.last()?);
    let mm = |nm: i64| Length::from_nm(nm).map_or(0.0, |length| f64::from(length.nm()) / 1e6);
    let spacing = points.get(1).map_or(i64::from(PitchTable::SPACING_NM.1), |second| second.nm - first.nm);
    for (number, point) in (0..).zip(points) {
        let due = first.nm + spacing * number;
        if point.nm != due || spacing <= 0 {
            let cause =
                format!("{axis} {} does not follow evenly on the points before: {} would", mm(point.nm), mm(due));
            let cause = if spacing > 0 { cause } else { format!("{axis} {} does not rise", mm(point.nm)) };
            errors.push(told(name, point.line, &cause, "measure at even distances, in rising order"));
            return None;
        }
    }
    let values: Vec<i16> = points.iter().map(|point| point.error).collect();
    let made = Length::from_nm(first.nm)
        .zip(Length::from_nm(spacing))
        .map_or(Err(PitchError::Spacing), |(start, spacing)| PitchTable::new(start, spacing, &values));
    match made {
        Ok(table) => Some(table),
        Err(error) => {
            let (line, remedy) = match error {
                PitchError::Steep(point) => (
                    points.get(point + 1).unwrap_or(last).line,
                    "look for a wrong digit, or a position in the wrong unit",
                ),
                PitchError::TooMany => (points.get(POINTS).unwrap_or(last).line, "take every second point"),
                PitchError::Empty | PitchError::Spacing => (last.line, "measure at other distances"),
            };
            errors.push(told(name, line, &format!("{axis}: {error}"), remedy));
            None
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_are_read_as_they_are_written() {
        let tables = read("t", "# screw 7\n\nZ -10 0.04\nx 0 3\nz -2.5 -1.25 # by laser\nz 5 2\n").unwrap();
        let length = |nm| Length::from_nm(nm).unwrap();
        assert_eq!(tables.z, PitchTable::new(length(-10_000_000), length(7_500_000), &[0, -13, 20]).ok());
        assert_eq!(tables.x, PitchTable::new(length(0), length(100_000_000), &[30]).ok());
    }

    #[test]
    fn what_is_wrong_is_told_with_line_and_remedy() {
        for (text, message) in [
            ("", "error: t:1: there is no point in it\n   = write a line for each point: z 120.5 -3.2"),
            ("z 1", "error: t:1: a point has three words, not 2\n   = write axis, position"),
            ("z 0 0\ny 1 2", "error: t:2: there is no axis y\n"),
            ("z 0 zero", "error: t:1: zero is no number\n"),
            ("z 3000 0", "error: t:1: 3000 is out of range\n"),
            ("z NaN 0", "error: t:1: NaN is out of range\n"),
            ("z 0 4000", "error: t:1: 4000 is out of range\n"),
            (
                "z 0 0\nz 10 1\n\nz 21 2",
                "error: t:4: z 21 does not follow evenly on the points before: 20 would\n   = measure",
            ),
            ("z 0 0\nz 0 1", "error: t:1: z 0 does not rise\n"),
            (
                "z 0 0\nz 0.01 5",
                "error: t:2: z: the error changes by half of the distance and more between points 1 and 2",
            ),
            ("x 0 0\nx 0.001 0", "error: t:2: x: the points of a pitch error table are 0.01 to 100 mm apart\n"),
        ] {
            let errors = read("t", text).unwrap_err();
            assert!(errors.len() == 1 && errors[0].starts_with(message), "{text}: {errors:?}");
        }
        let many: String = (0..=POINTS).map(|point| format!("z {point} 0\n")).collect();
        assert!(
            read("t", &many).unwrap_err()[0].starts_with("error: t:129: z: a pitch error table has at most 128 points")
        );
    }
}
