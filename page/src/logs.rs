//! Logs of motions for playback in the page: thinned, compressed columns over time, with the run's expected results and figures.

use std::collections::BTreeSet;
use std::fmt::Write;

use armgen_codegen::document::excerpt;
use serde_json::{json, Map, Value};

use crate::html::{escape, pack};
use crate::rows::Row;

/// Maximum number of samples in a log; a plot cannot show more.
pub const SAMPLES: usize = 2000;

/// Maximum number of columns, several times as many as the longest arm with all its parameters needs.
const COLUMNS: usize = 4096;

/// Prefix of the column names of joint positions.
const POSITION: &str = "q_";

/// A run: a log with its results and figures.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Its name, unique within a page.
    pub name: String,
    /// Its description, in a single line; may be empty.
    pub title: String,
    /// The recorded columns; `None` for a run that has only numbers.
    pub log: Option<Log>,
    /// Measured results with the expected results.
    pub verdicts: Vec<Verdict>,
    /// The figures.
    pub figures: Vec<Figure>,
}

/// A figure of a run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Figure {
    /// The title.
    pub title: String,
    /// The SVG text.
    pub svg: String,
}

/// A row of the table of results.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// The quantity and its evaluation: `max |e_z| in [5, 20] s`.
    pub what: String,
    /// The name of the quantity.
    pub name: String,
    /// Explanation of the quantity in words; may be empty.
    pub meaning: String,
    /// The measured value, with its unit.
    pub found: String,
    /// The expected value.
    pub expected: String,
    /// Whether the measured value is as expected.
    pub met: bool,
}

/// Columns over time.
#[derive(Clone, Debug)]
pub struct Log {
    names: Vec<String>,
    units: Vec<String>,
    columns: Vec<Vec<f64>>,
}

impl Log {
    /// Reads comma-separated values: a line of names, the first of them `t`, then a line per sample. `unit` gives the unit of each name.
    ///
    /// # Errors
    /// The text is not such a table; the message gives the line.
    pub fn read(text: &str, unit: impl Fn(&str) -> String) -> Result<Log, String> {
        let mut lines = text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty());
        let (_, head) = lines.next().ok_or("the log is empty; its first line names the columns")?;
        let names: Vec<String> = head.split(',').map(|name| name.trim().to_owned()).collect();
        if names[0] != "t" {
            return Err(format!("the first column is `{}`; it must be `t`, the time in s", names[0]));
        }
        if names.len() > COLUMNS {
            return Err(format!(
                "{} columns are more than the {COLUMNS} of a page: leave out those that are not looked at",
                names.len()
            ));
        }
        let mut seen = BTreeSet::new();
        if let Some(name) = names.iter().find(|name| !seen.insert(*name)) {
            return Err(format!("two columns are called `{name}`"));
        }
        let mut rows: Vec<Vec<f64>> = Vec::new();
        for (k, line) in lines {
            let number = |(j, word): (usize, &str)| {
                let column = names.get(j).map_or_else(|| format!("column {}", j + 1), |name| format!("column `{name}`"));
                let fault = |_| match word.trim() {
                    "" => format!("line {}: {column} is empty", k + 1),
                    word => format!("line {}: `{}` in {column} is no number", k + 1, excerpt(word)),
                };
                word.trim().parse::<f64>().map_err(fault)
            };
            let row = line.split(',').enumerate().map(number).collect::<Result<Vec<f64>, String>>()?;
            if row.len() != names.len() {
                return Err(format!("line {}: {} entries, and {} columns have names", k + 1, row.len(), names.len()));
            }
            if rows.last().is_some_and(|before| before[0].partial_cmp(&row[0]) != Some(std::cmp::Ordering::Less)) {
                return Err(format!("line {}: the time does not grow", k + 1));
            }
            rows.push(row);
        }
        if rows.is_empty() {
            return Err("the log has no samples, only the names of its columns".into());
        }
        let stride = rows.len().div_ceil(SAMPLES).max(1);
        let last = rows.len().saturating_sub(1);
        let kept: Vec<&Vec<f64>> =
            rows.iter().enumerate().filter(|(k, _)| k % stride == 0 || *k == last).map(|(_, row)| row).collect();
        let columns = (0..names.len()).map(|j| kept.iter().map(|row| row[j]).collect()).collect();
        Ok(Log { units: names.iter().map(|name| unit(name)).collect(), names, columns })
    }

    /// The joints with a column of positions.
    fn joints(&self) -> Vec<&str> {
        self.names.iter().filter_map(|name| name.strip_prefix(POSITION)).collect()
    }

    /// Whether its joints match the arm's joints; a log without joints matches any arm.
    pub(crate) fn fits(&self, joints: &[&str]) -> Result<(), String> {
        let own = self.joints();
        if own.is_empty() || own == joints {
            return Ok(());
        }
        Err(format!("its joints are {}, and the arm's are {}", own.join(", "), joints.join(", ")))
    }

    /// The columns with the digits for the page; `None` for a number that is not finite.
    fn written(&self) -> Vec<Vec<Option<f64>>> {
        let digits = |x: f64| format!("{x:.6e}").parse().unwrap_or(x);
        let column = |(j, column): (usize, &Vec<f64>)| {
            column.iter().map(|&x| Some(if j == 0 { x } else { digits(x) }).filter(|x| x.is_finite())).collect()
        };
        self.columns.iter().enumerate().map(column).collect()
    }

    /// The compressed columns: the time with all digits, because a log may begin late, and the others with seven.
    /// `rows` decide between the two units of a joint's column.
    fn packed(&self, rows: &[Row]) -> String {
        let units: Vec<&str> = self.names.iter().zip(&self.units).map(|(name, unit)| of_joint(name, unit, rows)).collect();
        pack(&json!({"names": self.names, "units": units, "columns": self.written()}).to_string())
    }
}

/// For a joint's column with two units, such as `rad, m`: the first for a revolute joint, the second for a prismatic joint.
fn of_joint<'u>(name: &str, unit: &'u str, rows: &[Row]) -> &'u str {
    let Some((turning, sliding)) = unit.split_once(", ") else { return unit };
    let ends_with = |row: &&Row| name.strip_suffix(&row.name).is_some_and(|kind| kind.ends_with('_'));
    // `q_b_a` belongs to the joint `b_a`, even if a joint `a` exists.
    let joint = rows.iter().filter(ends_with).max_by_key(|row| row.name.len());
    joint.map_or(unit, |row| if row.revolute { turning } else { sliding })
}

/// The input of the script, keyed by the names of the runs.
pub(crate) fn data(runs: &[Run], rows: &[Row]) -> Value {
    let of = |run: &Run| {
        let figures: Vec<Value> = run.figures.iter().map(|figure| json!([figure.title, pack(&figure.svg)])).collect();
        (run.name.clone(), json!({"log": run.log.as_ref().map(|log| log.packed(rows)), "figures": figures}))
    };
    Value::Object(runs.iter().map(of).collect::<Map<_, _>>())
}

/// The heading of the section: runs with results are experiments.
pub(crate) fn title(runs: &[Run]) -> &'static str {
    if runs.iter().any(|run| !run.verdicts.is_empty()) {
        "Experiments"
    } else {
        "Logs"
    }
}

pub(crate) fn section(runs: &[Run]) -> String {
    let mut text = String::from(CONTROLS);
    let all: Vec<&Verdict> = runs.iter().flat_map(|run| &run.verdicts).collect();
    if !all.is_empty() {
        let _ = writeln!(text, "<p>All runs together:{}</p>", as_expected(&all));
    }
    for run in runs {
        let name = escape(&run.name);
        let verdict = as_expected(&run.verdicts.iter().collect::<Vec<_>>());
        let _ = writeln!(
            text,
            "<details class=\"run\" data-log=\"{name}\"><summary><b>{name}</b> {}{verdict}</summary>",
            escape(&run.title)
        );
        if !run.verdicts.is_empty() {
            text += "<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Expectations\"><table><thead><tr>";
            for column in ["quantity", "found", "expected", "verdict"] {
                let _ = write!(text, "<th scope=\"col\">{column}</th>");
            }
            text += "</tr></thead><tbody>\n";
            for Verdict { what, found, expected, met, .. } in &run.verdicts {
                let cells = [what, found, expected].map(|cell| format!("<td>{}</td>", escape(cell))).concat();
                let (class, word) = if *met { ("met", "as expected") } else { ("unmet", "NOT as expected") };
                let _ = writeln!(text, "<tr class=\"{class}\">{cells}<td>{word}</td></tr>");
            }
            text += "</tbody></table></div>\n";
            text += &meanings(&run.verdicts);
        }
        text += "<div class=\"plots\"></div><div class=\"figures\"></div></details>\n";
    }
    text
}

/// The meanings of the quantities in a table, each once.
fn meanings(verdicts: &[Verdict]) -> String {
    let mut all: Vec<(&str, Vec<&str>)> = Vec::new();
    for Verdict { name, meaning, .. } in verdicts.iter().filter(|verdict| !verdict.meaning.is_empty()) {
        match all.iter_mut().find(|(known, _)| known == meaning) {
            Some((_, names)) if names.contains(&name.as_str()) => {}
            Some((_, names)) => names.push(name),
            None => all.push((meaning, vec![name])),
        }
    }
    let entry = |(meaning, names): &(&str, Vec<&str>)| {
        let named: Vec<String> = names.iter().take(NAMED).map(|name| format!("<b>{}</b>", escape(name))).collect();
        format!("{}{}: {}", named.join(", "), if names.len() > NAMED { ", …" } else { "" }, escape(meaning))
    };
    let entries: Vec<String> = all.iter().map(entry).collect();
    if entries.is_empty() {
        String::new()
    } else {
        format!("<p class=\"small\">{}.</p>\n", entries.join("; "))
    }
}

/// Up to this number, the text lists all names with the same meaning.
const NAMED: usize = 4;

/// The number of verdicts as expected; empty without verdicts.
fn as_expected(verdicts: &[&Verdict]) -> String {
    let met = verdicts.iter().filter(|verdict| verdict.met).count();
    match (verdicts.len(), met) {
        (0, _) => String::new(),
        (all, met) if all == met => format!(" <span class=\"met\">{met} of {all} as expected</span>"),
        (all, met) => format!(" <strong class=\"unmet\">{met} of {all} as expected</strong>"),
    }
}

const CONTROLS: &str = "<div class=\"controls\" id=\"playback\"><button type=\"button\" id=\"log-play\" disabled aria-pressed=\"false\">play</button>\
<label for=\"time\" id=\"time-of\">time</label><input type=\"range\" id=\"time\" disabled min=\"0\" max=\"1\" value=\"0\" step=\"any\"><span><input type=\"text\" id=\"time-value\" disabled autocomplete=\"off\" aria-label=\"time, s\"> s</span></div>
<p class=\"small\" id=\"playback-said\">Open a run: the arm follows its log, and the plots have a common cursor; a click into a plot goes to its time, and so does a time that is typed.</p>
";

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Log, String> {
        Log::read(text, |_| String::new())
    }

    #[test]
    fn what_is_no_log_is_refused_with_its_line() {
        let fault = |text: &str| read(text).unwrap_err();
        assert_eq!(fault("quantity,value\nw,1\n"), "the first column is `quantity`; it must be `t`, the time in s");
        assert_eq!(fault("t,x,x\n"), "two columns are called `x`");
        assert_eq!(fault("t,x\n0,1\n1\n"), "line 3: 1 entries, and 2 columns have names");
        assert_eq!(fault("t,x\n0,1\n0,2\n"), "line 3: the time does not grow");
        assert_eq!(fault("t,x\n0,one\n"), "line 2: `one` in column `x` is no number");
        assert_eq!(fault("t,x\n0,1,\n"), "line 2: column 3 is empty");
        assert_eq!(fault("t,q_a\n\n"), "the log has no samples, only the names of its columns");
        assert!(fault("").contains("empty"));
        let columns = |count: usize| format!("t{}\n", (1..count).map(|k| format!(",x{k}")).collect::<String>());
        assert!(fault(&columns(4097)).starts_with("4097 columns are more than the 4096 of a page"));
        assert!(read(&(columns(4096) + &"1,".repeat(4095) + "1\n")).is_ok());
    }

    /// Robot clocks write seconds since 1970.
    #[test]
    fn a_time_that_begins_late_keeps_its_digits() {
        let log = read("t,x\n1764118000.0,1.23456789\n1764118000.1,inf\n").unwrap();
        assert_eq!(log.written(), [[Some(1764118000.0), Some(1764118000.1)], [Some(1.234568), None]]);
    }

    #[test]
    fn a_column_has_the_unit_of_the_joint_whose_whole_name_it_has() {
        let row = |name: &str, revolute: bool| Row {
            name: name.into(),
            branch: None,
            revolute,
            denavit_hartenberg: None,
            urdf: None,
            before: Vec::new(),
            axis: [0.0, 0.0, 1.0],
            after: Vec::new(),
            limits: None,
            limits_written: String::new(),
            line: 0,
        };
        for rows in [[row("a", true), row("b_a", false)], [row("b_a", false), row("a", true)]] {
            let of = |name: &str| of_joint(name, "rad, m", &rows);
            assert_eq!(["q_a", "eq_a", "q_b_a", "q_c"].map(of), ["rad", "rad", "m", "rad, m"]);
        }
    }

    #[test]
    fn joints_are_those_of_the_arm() {
        let log = read("t,q_a,q_b,e_x\n0,1,2,3\n").unwrap();
        assert_eq!(log.fits(&["a", "b"]), Ok(()));
        assert_eq!(log.fits(&["a", "c"]), Err("its joints are a, b, and the arm's are a, c".into()));
        assert_eq!(read("t,x\n0,1\n").unwrap().fits(&["a"]), Ok(()));
    }

    #[test]
    fn a_meaning_stands_once_with_the_names_that_have_it() {
        let verdict = |name: &str, meaning: &str| Verdict {
            what: format!("max |{name}|"),
            name: name.into(),
            meaning: meaning.into(),
            found: String::new(),
            expected: String::new(),
            met: true,
        };
        let all =
            [verdict("eq_a", "an error"), verdict("w<", "w & more"), verdict("eq_b", "an error"), verdict("eq_a", "an error")];
        assert_eq!(meanings(&all), "<p class=\"small\"><b>eq_a</b>, <b>eq_b</b>: an error; <b>w&lt;</b>: w &amp; more.</p>\n");
        assert_eq!(meanings(&[verdict("runs", "")]), "");
        let many: Vec<Verdict> = ["q1.x", "q1.y", "q1.z", "q2.x", "q2.y"].map(|name| verdict(name, "where")).into();
        assert!(meanings(&many).ends_with("<b>q2.x</b>, …: where.</p>\n"));
    }

    #[test]
    fn long_logs_are_thinned_and_keep_their_last_sample() {
        let rows: String = (0..10_001).map(|k| format!("{k},{}\n", k * k)).collect();
        let log = read(&format!("t,x\n{rows}")).unwrap();
        assert!(log.columns[0].len() <= SAMPLES && log.columns[0].last() == Some(&10_000.0));
    }
}
