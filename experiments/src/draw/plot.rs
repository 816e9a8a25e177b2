//! Panels with axes: linear or logarithmic, free or with equal scales; ticks, labels with units, a legend above the panel.

use super::labels;
use super::svg::{Anchor, Stroke, Svg, INK, PALE};

/// Colours that differ in colour-blind vision and in grey (Okabe, Ito), each with a dash pattern for print.
const STYLES: [(&str, &str); 8] = [
    ("#0072b2", ""),
    ("#d55e00", "7 3"),
    ("#009e73", "2 2"),
    ("#cc79a7", "8 3 2 3"),
    ("#a36a00", "4 2"),
    ("#56b4e9", ""),
    ("#000000", "1 2"),
    ("#7f7f7f", "10 2"),
];

/// The line style of the `i`-th series.
pub(super) fn style(i: usize) -> Stroke {
    let (colour, dash) = STYLES[i % STYLES.len()];
    Stroke { colour, width: 1.4, dash }
}

/// The desired curve, drawn below the actual curve.
pub(super) const WIDE: Stroke = Stroke { colour: "#f0b070", width: 4.0, dash: "" };

/// A curve.
#[derive(Clone, Debug)]
pub(super) struct Series {
    /// Name in the legend; empty to omit the curve there.
    pub(super) name: String,
    pub(super) points: Vec<(f64, f64)>,
    pub(super) stroke: Stroke,
}

/// A plot.
#[derive(Clone, Debug, Default)]
pub(super) struct Panel {
    pub(super) title: String,
    /// Quantity and unit.
    pub(super) x: (String, String),
    pub(super) y: (String, String),
    /// Logarithmic y axis; zero lies below the panel.
    pub(super) log: bool,
    /// The same scale along both axes.
    pub(super) equal: bool,
    /// Fixed range of y; by default the range of the series.
    pub(super) range: Option<(f64, f64)>,
    pub(super) series: Vec<Series>,
    /// Points with labels.
    pub(super) marks: Vec<(f64, f64, String)>,
}

impl Panel {
    /// A panel over time.
    pub(super) fn over_time(title: &str, quantity: &str, unit: &str) -> Panel {
        Panel { title: title.into(), x: ("t".into(), "s".into()), y: (quantity.into(), unit.into()), ..Panel::default() }
    }

    /// Adds a curve in the next style.
    pub(super) fn add(&mut self, name: &str, points: Vec<(f64, f64)>) {
        let stroke = style(self.series.len());
        self.series.push(Series { name: name.into(), points, stroke });
    }

    /// The name of a curve in the legend; with a reason if the logarithmic axis cannot show the curve.
    fn legend_name(&self, series: &Series) -> String {
        let low = self.range.or_else(|| self.decades()).map_or(0.0, |(low, _)| low);
        let largest = series.points.iter().map(|p| p.1).filter(|y| y.is_finite()).reduce(f64::max);
        if self.log && largest.is_some_and(|y| y < low) {
            format!("{} (below 10{})", series.name, superscript(low.log10().round() as i32))
        } else {
            series.name.clone()
        }
    }

    /// Range of a logarithmic axis: whole decades, at most seven.
    pub(super) fn decades(&self) -> Option<(f64, f64)> {
        let values = || self.series.iter().flat_map(|s| &s.points).map(|p| p.1).filter(|y| *y > 0.0 && y.is_finite());
        let top = values().fold(0.0, f64::max);
        if top == 0.0 {
            return None;
        }
        let high = top.log10().ceil();
        let low = values().fold(top, f64::min).log10().floor().max(high - 7.0);
        Some((10f64.powf(low), 10f64.powf(high.max(low + 1.0))))
    }
}

const LEFT: f64 = 62.0;
const RIGHT: f64 = 14.0;
const LINE: f64 = 16.0;
const BELOW: f64 = 40.0;

/// A figure with a title and its panels in this number of columns.
pub(super) fn figure(title: &str, panels: &[Panel], columns: usize, panel: (f64, f64)) -> String {
    let columns = columns.clamp(1, panels.len().max(1));
    let head = 34.0;
    let heights: Vec<f64> = panels.chunks(columns).map(|row| row.iter().map(|p| above(p, panel.0)).fold(0.0, f64::max)).collect();
    let height = head + heights.iter().map(|above| above + panel.1 + BELOW).sum::<f64>() + 4.0;
    let width = columns as f64 * panel.0;
    let mut svg = Svg::new(width, height);
    svg.text((width / 2.0, 22.0), 15.0, Anchor::Middle, false, title);
    let mut y = head;
    for (row, above) in panels.chunks(columns).zip(&heights) {
        for (i, p) in row.iter().enumerate() {
            let x = i as f64 * panel.0;
            draw(&mut svg, p, (x, y), *above, (x + LEFT, y + above, panel.0 - LEFT - RIGHT, panel.1));
        }
        y += above + panel.1 + BELOW;
    }
    svg.text_of()
}

/// Estimated width of a text: slightly more than most fonts need, because no font is measured.
fn width_of(text: &str, size: f64) -> f64 {
    text.chars().count() as f64 * size * 0.56
}

/// Names of the legend, line by line.
fn legend(panel: &Panel, width: f64) -> Vec<Vec<&Series>> {
    let mut lines: Vec<Vec<&Series>> = Vec::new();
    let mut used = f64::INFINITY;
    for series in panel.series.iter().filter(|s| !s.name.is_empty()) {
        let needed = 34.0 + width_of(&panel.legend_name(series), 11.0);
        if used + needed > width {
            lines.push(Vec::new());
            used = 0.0;
        }
        used += needed;
        if let Some(line) = lines.last_mut() {
            line.push(series);
        }
    }
    lines
}

fn above(panel: &Panel, width: f64) -> f64 {
    let title = if panel.title.is_empty() { 0.0 } else { 18.0 };
    title + legend(panel, width - LEFT - RIGHT).len() as f64 * LINE + 6.0
}

/// An axis: maps values to pixels.
#[derive(Clone, Copy)]
struct Axis {
    from: f64,
    to: f64,
    log: bool,
    /// Pixels at both ends.
    start: f64,
    end: f64,
}

impl Axis {
    fn at(&self, x: f64) -> f64 {
        let part =
            if self.log { (x / self.from).ln() / (self.to / self.from).ln() } else { (x - self.from) / (self.to - self.from) };
        self.start + part * (self.end - self.start)
    }

    /// Values with a tick, and the common power of ten of their labels.
    fn ticks(&self) -> (Vec<f64>, i32) {
        if self.log {
            let (low, high) = (self.from.log10().round() as i32, self.to.log10().round() as i32);
            let stride = (f64::from(high - low) / 8.0).ceil().max(1.0) as i32;
            return ((low..=high).filter(|k| (high - k) % stride == 0).map(|k| 10f64.powi(k)).collect(), 0);
        }
        // Labels along a horizontal axis need more space than labels along a vertical axis.
        let room = if self.end < self.start { 30.0 } else { 55.0 };
        let wanted = ((self.end - self.start).abs() / room).clamp(3.0, 10.0);
        let rough = (self.to - self.from) / wanted;
        let power = 10f64.powf(rough.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0].into_iter().map(|m| m * power).find(|s| *s >= rough * 0.999).unwrap_or(rough);
        let (first, last) = ((self.from / step - 1e-9).ceil() as i64, (self.to / step + 1e-9).floor() as i64);
        let largest = self.from.abs().max(self.to.abs());
        let exponent = if largest > 0.0 { largest.log10().floor() as i32 } else { 0 };
        // A common power avoids labels that are too wide: large numbers, and small numbers with three decimals.
        let plain = (0..4).contains(&exponent) || ((-2..0).contains(&exponent) && step > 0.0099);
        let out = if plain { 0 } else { exponent.div_euclid(3) * 3 };
        ((first..=last).map(|k| k as f64 * step).collect(), out)
    }
}

fn superscript(power: i32) -> String {
    let digits = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    let text = power.to_string();
    text.chars().map(|c| c.to_digit(10).map_or('⁻', |d| digits[d as usize])).collect()
}

fn tick_label(value: f64, axis: &Axis, out: i32, step: f64) -> String {
    if axis.log {
        return format!("10{}", superscript(value.log10().round() as i32));
    }
    let scale = 10f64.powi(out);
    let decimals = (-(step / scale).log10()).ceil().clamp(0.0, 6.0) as usize;
    let text = format!("{:.*}", decimals, value / scale);
    if text.trim_start_matches('-').chars().all(|c| c == '0' || c == '.') {
        "0".into()
    } else {
        text.replace('-', "−")
    }
}

fn axis_label((quantity, unit): &(String, String), out: i32) -> String {
    let factor = if out == 0 { String::new() } else { format!("10{} ", superscript(out)) };
    let unit = format!("{factor}{unit}");
    match (quantity.is_empty(), unit.trim()) {
        (true, _) => String::new(),
        (_, "") => quantity.clone(),
        (_, unit) => format!("{quantity} ({unit})"),
    }
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.filter(|x| x.is_finite()).fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(x), b.max(x)));
    if low > high {
        return (0.0, 1.0);
    }
    let margin = if high > low { 0.04 * (high - low) } else { 0.5f64.max(high.abs() * 0.05) };
    (low - margin, high + margin)
}

fn axes(panel: &Panel, (x, y, w, h): (f64, f64, f64, f64)) -> (Axis, Axis) {
    let points = || panel.series.iter().flat_map(|s| &s.points);
    let marks = || panel.marks.iter();
    let over_time = panel.x.1 == "s";
    let (mut x0, mut x1) = range(points().map(|p| p.0).chain(marks().map(|m| m.0)));
    if over_time {
        // The time axis has no margin.
        let inner = (x1 - x0) / 1.08 * 0.04;
        (x0, x1) = (x0 + inner, x1 - inner);
    }
    let (mut y0, mut y1) = match (panel.range, panel.log) {
        (Some(range), _) => range,
        (None, true) => panel.decades().unwrap_or((0.1, 1.0)),
        (None, false) => range(points().map(|p| p.1).chain(marks().map(|m| m.1))),
    };
    if panel.equal {
        let scale = ((x1 - x0) / w).max((y1 - y0) / h);
        let widen = |a: f64, b: f64, length: f64| ((a + b - scale * length) / 2.0, (a + b + scale * length) / 2.0);
        (x0, x1) = widen(x0, x1, w);
        (y0, y1) = widen(y0, y1, h);
    }
    (Axis { from: x0, to: x1, log: false, start: x, end: x + w }, Axis { from: y0, to: y1, log: panel.log, start: y + h, end: y })
}

fn draw(svg: &mut Svg, panel: &Panel, (left, top): (f64, f64), above: f64, area: (f64, f64, f64, f64)) {
    let (x, y, w, h) = area;
    let (across, up) = axes(panel, area);
    let lines = legend(panel, w);
    if !panel.title.is_empty() {
        svg.text((x + w / 2.0, top + 12.0), 12.5, Anchor::Middle, false, &panel.title);
    }
    for (i, line) in lines.iter().enumerate() {
        let base = top + above - 4.0 - (lines.len() - 1 - i) as f64 * LINE;
        let mut at = x;
        for series in line {
            svg.line(
                &[(at, base - 4.0), (at + 22.0, base - 4.0)],
                Stroke { width: series.stroke.width.max(1.4), ..series.stroke },
            );
            let name = panel.legend_name(series);
            svg.text((at + 26.0, base), 11.0, Anchor::Start, false, &name);
            at += 34.0 + width_of(&name, 11.0);
        }
    }
    let grid = Stroke { colour: PALE, width: 0.6, dash: "" };
    let (x_ticks, x_out) = across.ticks();
    let step = |ticks: &[f64]| ticks.windows(2).map(|t| t[1] - t[0]).next().unwrap_or(1.0);
    for value in &x_ticks {
        let at = across.at(*value);
        svg.line(&[(at, y), (at, y + h)], grid);
        svg.text((at, y + h + 14.0), 10.5, Anchor::Middle, false, &tick_label(*value, &across, x_out, step(&x_ticks)));
    }
    let (y_ticks, y_out) = up.ticks();
    for value in &y_ticks {
        let at = up.at(*value);
        svg.line(&[(x, at), (x + w, at)], grid);
        svg.text((x - 5.0, at + 3.5), 10.5, Anchor::End, false, &tick_label(*value, &up, y_out, step(&y_ticks)));
    }
    let curves: Vec<(Vec<(f64, f64)>, Stroke)> = panel
        .series
        .iter()
        .flat_map(|series| pieces(&series.points, &across, &up).into_iter().map(|piece| (thin(&piece), series.stroke)))
        .collect();
    let places: Vec<(f64, f64)> = panel.marks.iter().map(|(px, py, _)| (across.at(*px), up.at(*py))).collect();
    svg.clipped(area, |svg| {
        for (curve, stroke) in &curves {
            svg.line(curve, *stroke);
        }
        for (px, py) in &places {
            svg.dot(*px, *py, 2.4, INK);
        }
    });
    const SIZE: f64 = 10.5;
    let curves: Vec<Vec<(f64, f64)>> = curves.into_iter().map(|(curve, _)| curve).collect();
    let widths: Vec<f64> = panel.marks.iter().map(|(.., text)| width_of(text, SIZE)).collect();
    for ((.., text), (at, anchor)) in panel.marks.iter().zip(labels::place(&places, &widths, SIZE, &curves, area)) {
        if !text.is_empty() {
            svg.text(at, SIZE, anchor, false, text);
        }
    }
    svg.frame(area);
    svg.text((x + w / 2.0, y + h + 30.0), 11.5, Anchor::Middle, false, &axis_label(&panel.x, x_out));
    svg.text((left + 14.0, y + h / 2.0), 11.5, Anchor::Middle, true, &axis_label(&panel.y, y_out));
}

/// Distance beyond its panel up to which a curve is drawn (and clipped), px.
const OUTSIDE: f64 = 40.0;

/// The pixels of the points, cut where a value is not finite; on a logarithmic axis zero lies below the panel.
fn pieces(points: &[(f64, f64)], across: &Axis, up: &Axis) -> Vec<Vec<(f64, f64)>> {
    let mut pieces = vec![Vec::new()];
    for (x, y) in points {
        let shown = x.is_finite() && y.is_finite();
        let place = if up.log && *y <= 0.0 { f64::INFINITY } else { up.at(*y) };
        match (shown, pieces.last_mut()) {
            // Outside the panel only the side of a coordinate matters.
            (true, Some(piece)) => piece.push((across.at(*x), place.clamp(up.end - OUTSIDE, up.start + OUTSIDE))),
            (false, Some(piece)) if !piece.is_empty() => pieces.push(Vec::new()),
            _ => {}
        }
    }
    pieces
}

/// Fewer points with the same look: per step of x the first, lowest, highest and last, minus those that a straight line replaces.
fn thin(points: &[(f64, f64)]) -> Vec<(f64, f64)> {
    let monotonic = points.windows(2).all(|p| p[1].0 >= p[0].0);
    let mut kept: Vec<(f64, f64)> = Vec::new();
    if monotonic && points.len() > 2000 {
        for bucket in points.chunk_by(|a, b| (a.0 / 1.5).floor() == (b.0 / 1.5).floor()) {
            let by = |better: fn(f64, f64) -> bool| {
                (0..bucket.len()).fold(0, |best, i| if better(bucket[i].1, bucket[best].1) { i } else { best })
            };
            let mut chosen = [0, by(|a, b| a < b), by(|a, b| a > b), bucket.len() - 1];
            chosen.sort_unstable();
            let mut last = None;
            for i in chosen {
                if last != Some(i) {
                    kept.push(bucket[i]);
                }
                last = Some(i);
            }
        }
    } else {
        kept.extend_from_slice(points);
    }
    simplify(&kept, 0.2)
}

/// Ramer, Douglas and Peucker: keeps points farther than `tolerance` from the line that would replace them.
fn simplify(points: &[(f64, f64)], tolerance: f64) -> Vec<(f64, f64)> {
    if points.len() < 3 {
        return points.to_vec();
    }
    let mut keep = vec![false; points.len()];
    keep[0] = true;
    keep[points.len() - 1] = true;
    let mut open = vec![(0, points.len() - 1)];
    while let Some((a, b)) = open.pop() {
        let (p, q) = (points[a], points[b]);
        let (dx, dy) = (q.0 - p.0, q.1 - p.1);
        let length = dx.hypot(dy);
        let distance = |r: (f64, f64)| {
            if length > 1e-9 {
                ((r.0 - p.0) * dy - (r.1 - p.1) * dx).abs() / length
            } else {
                (r.0 - p.0).hypot(r.1 - p.1)
            }
        };
        let worst = (a + 1..b).map(|i| (distance(points[i]), i)).fold((0.0, a), |m, d| if d.0 > m.0 { d } else { m });
        if worst.0 > tolerance {
            keep[worst.1] = true;
            open.push((a, worst.1));
            open.push((worst.1, b));
        }
    }
    points.iter().zip(keep).filter(|(_, keep)| *keep).map(|(p, _)| *p).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn thinned_lines_keep_their_shape_and_their_peaks() {
        let mut points: Vec<(f64, f64)> =
            (0..20_000).map(|k| (f64::from(k) * 0.03, (f64::from(k) * 1e-3).sin() * 80.0)).collect();
        points[7777].1 = 500.0;
        let kept = thin(&points);
        assert!(kept.len() < 400, "{}", kept.len());
        assert!(kept.iter().any(|p| p.1 == 500.0));
        assert_eq!((kept.first(), kept.last()), (points.first(), points.last()));
    }

    #[test]
    fn ticks_are_round_and_labels_carry_their_power() {
        let axis = Axis { from: -1.2e-6, to: 3.1e-6, log: false, start: 0.0, end: 300.0 };
        let (ticks, out) = axis.ticks();
        assert_eq!(out, -6);
        let labels: Vec<String> = ticks.iter().map(|t| tick_label(*t, &axis, out, 1e-6)).collect();
        assert_eq!(labels, ["−1", "0", "1", "2", "3"]);
        assert_eq!(axis_label(&("error".into(), "m".into()), out), "error (10⁻⁶ m)");
        let out_of = |from: f64, to: f64| Axis { from, to, log: false, start: 165.0, end: 0.0 }.ticks().1;
        assert_eq!([out_of(-0.05, 0.02), out_of(-0.012, 0.004), out_of(0.0, 0.5), out_of(0.0, 1200.0)], [0, -3, 0, 0]);
    }

    #[test]
    fn a_curve_below_the_axis_is_named_so() {
        let mut panel = Panel { log: true, ..Panel::default() };
        panel.add("seen", vec![(0.0, 1e-3), (1.0, 2e-9)]);
        panel.add("unseen", vec![(0.0, 0.0), (1.0, 1e-15)]);
        let names: Vec<String> = panel.series.iter().map(|series| panel.legend_name(series)).collect();
        assert_eq!(names, ["seen", "unseen (below 10⁻¹⁰)"]);
    }
}
