//! The report of an identification as one page: tables and figures in a file that needs no network.

use std::fmt::Write;

use crate::arm::Arm;
use crate::finding::Findings;
use crate::identify::{Identified, Input, Interval};
use crate::judge::Judgement;
use crate::signal::spread;
use crate::written::Written;

const STYLE: &str = "body{font:15px/1.45 system-ui,sans-serif;color:#1a1a1a;background:#fff;max-width:1060px;margin:2em auto;padding:0 1em}\
h1{font-size:1.6em}h2{font-size:1.2em;margin-top:2em}h3{font-size:1em;margin:1.4em 0 .3em}\
table{border-collapse:collapse;margin:.6em 0}th,td{padding:.15em .7em;text-align:left;border-bottom:1px solid #ddd;vertical-align:top}\
td.n{text-align:right;font-variant-numeric:tabular-nums;white-space:nowrap}svg{display:block;max-width:100%;height:auto}\
figure{margin:.6em 0;break-inside:avoid}figcaption{color:#444}.row{display:flex;flex-wrap:wrap;gap:1em}code{font-size:.92em}\
text{font:12px system-ui,sans-serif;fill:#333}.a{stroke:#1f5fa8}.b{stroke:#c8501e}.r{stroke:#555}.f{fill:none;stroke-width:1.2}\
.x{stroke:#999;stroke-width:1}.d{fill:#1f5fa8;fill-opacity:.45}.h{fill:#9db9d9}";

/// Text inside of markup.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn short(x: f64) -> String {
    match x {
        0.0 => "0".to_owned(),
        x if !x.is_finite() => "–".to_owned(),
        x if (1e-3..1e5).contains(&x.abs()) => {
            let decimals = (3 - x.abs().log10().floor() as i32).max(0) as usize;
            let text = format!("{x:.decimals$}");
            if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.').to_owned()
            } else {
                text
            }
        }
        x => format!("{x:.3e}"),
    }
}

fn milliseconds(seconds: f64) -> String {
    format!("{:.2} ms", (1e5 * seconds).round() / 100.0 + 0.0)
}

fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let mut text = String::from("<table><thead><tr>");
    head.iter().for_each(|cell| _ = write!(text, "<th>{}</th>", escaped(cell)));
    text += "</tr></thead><tbody>\n";
    for row in rows {
        text += "<tr>";
        for cell in row {
            // A combination of parameters begins with a number, too.
            let is_number = cell.starts_with(|c: char| c.is_ascii_digit() || c == '-' || c == '–') && !cell.contains('*');
            let _ = write!(text, "<td{}>{}</td>", if is_number { " class=n" } else { "" }, escaped(cell));
        }
        text += "</tr>\n";
    }
    text + "</tbody></table>\n"
}

/// A figure with axes.
struct Plot {
    size: [f64; 2],
    x: [f64; 2],
    y: [f64; 2],
    body: String,
}

/// Space for the numbers of the axes.
const LEFT: f64 = 58.0;
const BOTTOM: f64 = 34.0;
const TOP: f64 = 8.0;

/// Round numbers within a range.
fn ticks([low, high]: [f64; 2]) -> Vec<f64> {
    let rough = (high - low) / 5.0;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|k| k * power).find(|step| *step >= rough).unwrap_or(rough);
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last.min(first + 20)).map(|k| k as f64 * step).collect()
}

impl Plot {
    fn new(size: [f64; 2], x: [f64; 2], y: [f64; 2]) -> Plot {
        let wide = |[low, high]: [f64; 2]| match high - low {
            width if width > 1e-12 * (1.0 + low.abs()) => [low, high],
            _ => [low - 0.5, high + 0.5],
        };
        Plot { size, x: wide(x), y: wide(y), body: String::new() }
    }

    fn at(&self, x: f64, y: f64) -> [f64; 2] {
        let [width, height] = self.size;
        [
            LEFT + (x - self.x[0]) / (self.x[1] - self.x[0]) * (width - LEFT - 8.0),
            height - BOTTOM - (y - self.y[0]) / (self.y[1] - self.y[0]) * (height - BOTTOM - TOP),
        ]
    }

    fn line(&mut self, class: &str, points: impl Iterator<Item = (f64, f64)>) {
        let mut path = String::new();
        for (x, y) in points {
            let [x, y] = self.at(x, y);
            let _ = write!(path, "{x:.1},{y:.1} ");
        }
        let _ = writeln!(self.body, "<polyline class=\"f {class}\" points=\"{}\"/>", path.trim_end());
    }

    fn dots(&mut self, points: impl Iterator<Item = (f64, f64)>) {
        for (x, y) in points {
            let [x, y] = self.at(x, y);
            let _ = writeln!(self.body, "<circle class=d cx={x:.1} cy={y:.1} r=1.6 />");
        }
    }

    fn finish(self, of_x: &str, of_y: &str, caption: &str) -> String {
        let [width, height] = self.size;
        let mut text = format!(
            "<figure><svg viewBox=\"0 0 {width} {height}\" width={width} height={height} role=img aria-label=\"{}\">\n",
            escaped(caption)
        );
        for x in ticks(self.x) {
            let [at, bottom] = self.at(x, self.y[0]);
            let _ = writeln!(
                text,
                "<path class=x d=\"M{at:.1} {bottom:.1}v4\"/><text x={at:.1} y={:.1} text-anchor=middle>{}</text>",
                bottom + 16.0,
                short(x)
            );
        }
        for y in ticks(self.y) {
            let [left, at] = self.at(self.x[0], y);
            let _ = writeln!(
                text,
                "<path class=x d=\"M{left:.1} {at:.1}h-4\"/><text x={:.1} y={:.1} text-anchor=end>{}</text>",
                left - 7.0,
                at + 4.0,
                short(y)
            );
        }
        let ([left, top], [right, bottom]) = (self.at(self.x[0], self.y[1]), self.at(self.x[1], self.y[0]));
        let _ = writeln!(text, "<path class=\"x f\" d=\"M{left:.1} {top:.1}V{bottom:.1}H{right:.1}\"/>");
        text += &self.body;
        let _ = writeln!(text, "<text x={right:.1} y={:.1} text-anchor=end>{}</text>", height - 4.0, escaped(of_x));
        let _ = writeln!(text, "<text x={:.1} y={:.1}>{}</text>", left + 6.0, top + 12.0, escaped(of_y));
        format!("{text}</svg><figcaption>{}</figcaption></figure>\n", escaped(caption))
    }
}

fn range<'x>(all: impl Iterator<Item = &'x f64>) -> [f64; 2] {
    let [low, high] = all.filter(|x| x.is_finite()).fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(*x), b.max(*x)]);
    if low <= high {
        [low, high]
    } else {
        [0.0, 1.0]
    }
}

/// Points of a line and of a cloud at most.
const POINTS: usize = 700;
const DOTS: usize = 500;

/// Of each stretch of samples the least and the largest, so that no peak is lost.
fn thinned(t: &[f64], x: &[f64]) -> Vec<(f64, f64)> {
    let step = (2 * x.len()).div_ceil(POINTS).max(1);
    let mut points = Vec::new();
    for start in (0..x.len()).step_by(step) {
        let stretch = start..(start + step).min(x.len());
        let least = stretch.clone().min_by(|&a, &b| x[a].total_cmp(&x[b])).unwrap_or(start);
        let most = stretch.max_by(|&a, &b| x[a].total_cmp(&x[b])).unwrap_or(start);
        points.extend([least.min(most), least.max(most)].map(|k| (t[k], x[k])));
    }
    points.dedup();
    points
}

fn of_log(arm: &Arm, title: &str, of: &Judgement) -> String {
    let mut text = format!("<h2>{}</h2>\n", escaped(title));
    let unit = |j: usize| if arm.joints[j].slides { "N" } else { "N m" };
    let percent = |x: f64| format!("{:.2} %", 100.0 * x);
    let rows: Vec<Vec<String>> = (0..arm.dof())
        .map(|j| {
            vec![
                arm.joints[j].name.clone(),
                format!("{} {}", short(of.rms[j]), unit(j)),
                percent(of.relative[j]),
                percent(of.moving[j]),
                milliseconds(of.delays[j]),
            ]
        })
        .collect();
    text += &table(&["joint", "residual", "of the torque", "moving", "delay"], &rows);
    for contact in &of.contacts {
        let joints: Vec<&str> = contact.joints.iter().map(|&j| arm.joints[j].name.as_str()).collect();
        let _ = writeln!(
            text,
            "<p>Contact from {:.2} s to {:.2} s at {}.</p>",
            contact.from,
            contact.to,
            escaped(&joints.join(", "))
        );
    }
    for j in 0..arm.dof() {
        let (measured, predicted, times) = (&of.measured[j], &of.predicted[j], &of.times);
        if times.is_empty() {
            continue;
        }
        let (name, unit) = (&arm.joints[j].name, unit(j));
        let (of_angle, of_rate) = if arm.joints[j].slides { ("m", "m/s") } else { ("rad", "rad/s") };
        let residual: Vec<f64> = measured.iter().zip(predicted).map(|(a, b)| a - b).collect();
        let _ = writeln!(text, "<h3>{}</h3>", escaped(name));
        let mut plot = Plot::new([1040.0, 230.0], range(times.iter()), range(measured.iter().chain(predicted)));
        plot.line("a", thinned(times, measured).into_iter());
        plot.line("b", thinned(times, predicted).into_iter());
        text += &plot.finish("t (s)", &format!("torque ({unit})"), &format!("{name}: measured (blue) and predicted (orange)"));
        let mut plot = Plot::new([1040.0, 130.0], range(times.iter()), range(residual.iter()));
        plot.line("r", thinned(times, &residual).into_iter());
        text += &plot.finish("t (s)", &format!("residual ({unit})"), &format!("{name}: measured less predicted"));
        text += "<div class=row>\n";
        let step = residual.len().div_ceil(DOTS).max(1);
        for (signal, label) in [(&of.rates[j], format!("dq ({of_rate})")), (&of.positions[j], format!("q ({of_angle})"))] {
            let mut plot = Plot::new([500.0, 190.0], range(signal.iter()), range(residual.iter()));
            plot.dots(signal.iter().copied().zip(residual.iter().copied()).step_by(step));
            text += &plot.finish(&label, &format!("residual ({unit})"), &format!("{name}: residual over {label}"));
        }
        text += &histogram(name, &residual);
        text += &autocorrelation(name, times, &residual);
        text += "</div>\n";
    }
    text
}

/// The residual over its spread, with the normal curve.
fn histogram(name: &str, residual: &[f64]) -> String {
    let size = spread(residual).max(1e-300);
    let bins = 41;
    let at = |k: usize| -5.0 + 10.0 * k as f64 / bins as f64;
    let mut counts = vec![0.0; bins];
    for x in residual {
        let k = ((x / size + 5.0) / 10.0 * bins as f64).floor();
        if (0.0..bins as f64).contains(&k) {
            counts[k as usize] += bins as f64 / (10.0 * residual.len() as f64);
        }
    }
    let normal = |x: f64| (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
    let highest = counts.iter().copied().fold(0.45, f64::max);
    let mut plot = Plot::new([500.0, 190.0], [-5.0, 5.0], [0.0, highest]);
    for (k, count) in counts.iter().enumerate() {
        let ([left, top], [right, bottom]) = (plot.at(at(k), *count), plot.at(at(k + 1), 0.0));
        let _ = writeln!(
            plot.body,
            "<rect class=h x={left:.1} y={top:.1} width={:.1} height={:.1} />",
            (right - left).max(0.0),
            (bottom - top).max(0.0)
        );
    }
    plot.line("b", (0..=100).map(|k| -5.0 + 0.1 * f64::from(k)).map(|x| (x, normal(x))));
    plot.finish("residual over its spread", "density", &format!("{name}: residuals and the normal curve (orange)"))
}

fn autocorrelation(name: &str, times: &[f64], residual: &[f64]) -> String {
    let period = (times[times.len() - 1] - times[0]) / (times.len().max(2) - 1) as f64;
    let lags = residual.len().min((2.0 / period.max(1e-9)) as usize + 1).min(200);
    let mean = residual.iter().sum::<f64>() / residual.len() as f64;
    let of = |lag: usize| residual.iter().zip(&residual[lag..]).map(|(a, b)| (a - mean) * (b - mean)).sum::<f64>();
    let whole = of(0).max(1e-300);
    let mut plot = Plot::new([500.0, 190.0], [0.0, (lags.max(2) - 1) as f64 * period], [-0.5, 1.0]);
    plot.line("r", (0..lags).map(|lag| (lag as f64 * period, of(lag) / whole)));
    plot.finish("lag (s)", "autocorrelation", &format!("{name}: how long residuals remember"))
}

fn begin(arm: &Arm, what: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=en><head><meta charset=utf-8><meta name=viewport content=\"width=device-width\">\
         <title>{0}: {what}</title><style>{STYLE}</style></head><body>\n<h1>{0}: {what}</h1>\n",
        escaped(&arm.name)
    )
}

fn warnings(findings: &Findings) -> String {
    let all: Vec<String> = findings
        .iter()
        .map(|of| {
            let [log, text, help] = [&of.log, &of.text, &of.help].map(|text| escaped(text));
            format!("<li><code>{}</code> {log}: {text}. {help}</li>\n", of.code.name())
        })
        .collect();
    match all.is_empty() {
        true => String::new(),
        false => format!("<h2>Warnings</h2>\n<ul>\n{}</ul>\n", all.concat()),
    }
}

/// The page of a description that logs judge.
pub fn of_validation(arm: &Arm, validation: &[(String, Judgement)], findings: &Findings) -> String {
    let logs = validation.iter().map(|(name, of)| of_log(arm, &format!("Validation {name}"), of));
    format!("{}{}{}</body></html>\n", begin(arm, "validation"), warnings(findings), logs.collect::<String>())
}

/// Correlations of base parameters from here on are named.
const CORRELATED: f64 = 0.95;

/// The page. `proofs` tells what the certificate proves.
pub fn html(
    arm: &Arm,
    inputs: &[Input],
    found: &Identified,
    written: Option<(&Written, &str)>,
    validation: &[(String, Judgement)],
    findings: &Findings,
) -> String {
    let range_of = |of: &Interval| match of.excited && of.sigma > 0.0 {
        true => format!("{} to {}", short(of.low), short(of.high)),
        false => "kept".to_owned(),
    };
    let mut text = begin(arm, "identification");
    let _ = writeln!(
        text,
        "<p>{} samples used, rate {} Hz, cutoff {} Hz, {} stretches of time, condition {}, log det per parameter {}.</p>",
        found.used,
        short(found.rate),
        short(found.cutoff),
        found.blocks,
        short(found.condition),
        short(found.log_det_per_parameter)
    );
    text += &warnings(findings);
    let nominal = &arm.combination * arm.nominal();
    let constrained = written.map(|(written, _)| written.consistent.base(arm));
    let rows: Vec<Vec<String>> = (0..arm.base.len())
        .map(|k| {
            let of = &found.base[k];
            let own = constrained.as_ref().map_or_else(String::new, |base| short(base[k]));
            vec![arm.base[k].name.clone(), short(of.value), range_of(of), own, short(nominal[k]), arm.base[k].meaning.clone()]
        })
        .collect();
    text += "<h2>Base parameters</h2>\n";
    text += &table(&["name", "value", "3 sigma", "written", "file", "combination"], &rows);
    let n = found.covariance.nrows();
    for a in 0..n {
        for b in 0..a {
            let size = (found.covariance[(a, a)] * found.covariance[(b, b)]).sqrt();
            let correlation = found.covariance[(a, b)] / size;
            if correlation.abs() > CORRELATED {
                let (a, b) = (escaped(&arm.base[a].name), escaped(&arm.base[b].name));
                let _ = writeln!(text, "<p>{b} and {a} are correlated: {correlation:.3}.</p>");
            }
        }
    }
    for words in found.unexcited.iter().map(|(_, words)| words).chain(&found.inseparable) {
        let _ = writeln!(text, "<p>Not shown by the logs: {}.</p>", escaped(words));
    }
    let rows: Vec<Vec<String>> = found
        .friction
        .iter()
        .map(|of| {
            let joint = &arm.joints[of.joint];
            let file = joint.friction[of.term as usize].map_or_else(|| "–".to_owned(), short);
            let session = found.sessions[of.session].clone();
            vec![joint.name.clone(), of.term.key().to_owned(), short(of.value.value), range_of(&of.value), file, session]
        })
        .collect();
    text += "<h2>Friction</h2>\n";
    text += &table(&["joint", "term", "value", "3 sigma", "file", "session"], &rows);
    if !found.gains.is_empty() {
        let rows: Vec<Vec<String>> = found
            .gains
            .iter()
            .zip(&arm.joints)
            .map(|(of, joint)| vec![joint.name.clone(), short(of.value), range_of(of)])
            .collect();
        text += "<h2>Drive gains</h2>\n";
        text += &table(&["joint", "N m/A, N/A", "3 sigma"], &rows);
    }
    let of_delay = |(of, joint): (&Interval, &crate::arm::Joint)| {
        let range = match (of.excited, of.sigma > 0.0) {
            (false, _) => "not determined".to_owned(),
            (true, false) => "given".to_owned(),
            (true, true) => format!("{} to {}", milliseconds(of.low), milliseconds(of.high)),
        };
        vec![joint.name.clone(), milliseconds(of.value), range]
    };
    text += "<h2>Delays</h2>\n";
    text += &table(
        &["joint", "torque behind position", "3 sigma"],
        &found.delays.iter().zip(&arm.joints).map(of_delay).collect::<Vec<_>>(),
    );
    if let Some((written, proofs)) = written {
        text += "<h2>Certificate</h2>\n";
        proofs.lines().for_each(|line| _ = writeln!(text, "<p>{}</p>", escaped(line)));
        let of = &written.consistent;
        let above = 100.0 * (of.objective / of.unconstrained - 1.0);
        let _ = writeln!(text, "<p>The sum of squares of these bodies is {above:.2} % above its least value.</p>");
    }
    for (input, of) in inputs.iter().zip(&found.judgements) {
        text += &of_log(arm, &format!("Log {}", input.log.name), of);
    }
    for (name, of) in validation {
        text += &of_log(arm, &format!("Validation {name}"), of);
    }
    text + "</body></html>\n"
}
