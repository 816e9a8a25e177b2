//! From a figure to SVG.

use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::series::DashedLineSeries;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::Axis;
use super::{Figure, Panel, Scale, Series, Style};

/// Black, blue, vermilion, green, purple, orange, sky blue.
pub(super) const PALETTE: [RGBColor; 7] = [
    RGBColor(0, 0, 0),
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];

const WIDTH: u32 = 1000;
const TITLE: u32 = 36;
const FONT: &str = "sans-serif";
/// Pixels of the strips around a chart.
const LEFT: u32 = 72;
/// Of which so many stay empty.
const MARGIN: u32 = 10;
const BELOW: u32 = 46;
const RIGHT: u32 = 18;
const CAPTION: u32 = 26;
const LEGEND_LINE: u32 = 18;
const LETTER: f64 = 6.8;

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a> = ChartContext<'a, SVGBackend<'a>, Cartesian2d<Axis, Axis>>;
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

pub(super) fn svg(figure: &Figure) -> String {
    let height = TITLE + figure.rows.iter().map(|row| row.height).sum::<u32>();
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (WIDTH, height)).into_drawing_area();
        draw(figure, &root).expect("drawing into a string");
        root.present().expect("drawing into a string");
    }
    text
}

fn draw(figure: &Figure, root: &Area<'_>) -> Drawn {
    root.fill(&WHITE)?;
    let centred = (FONT, 20).into_font().color(&BLACK).pos(Pos::new(HPos::Center, VPos::Center));
    root.draw(&Text::new(figure.title.clone(), (WIDTH as i32 / 2, TITLE as i32 / 2), centred))?;
    let (_, mut rest) = root.split_vertically(TITLE);
    for row in &figure.rows {
        let (this, below) = rest.split_vertically(row.height);
        rest = below;
        let total: f64 = row.panels.iter().map(|panel| panel.width).sum();
        let mut right = this;
        let mut used = 0.0;
        for (i, panel) in row.panels.iter().enumerate() {
            let before = (used / total * f64::from(WIDTH)).round() as u32;
            used += panel.width;
            let after = (used / total * f64::from(WIDTH)).round() as u32;
            if i + 1 == row.panels.len() {
                draw_panel(panel, &right)?;
            } else {
                let (left, others) = right.split_horizontally(after - before);
                draw_panel(panel, &left)?;
                right = others;
            }
        }
    }
    Ok(())
}

fn draw_panel(panel: &Panel, area: &Area<'_>) -> Drawn {
    let (width, height) = area.dim_in_pixel();
    let caption = (FONT, 15).into_font().color(&BLACK).pos(Pos::new(HPos::Center, VPos::Center));
    let middle = (LEFT + width - RIGHT) as i32 / 2;
    area.draw(&Text::new(panel.title.clone(), (middle, CAPTION as i32 / 2 + 2), caption))?;
    let legend = legend(panel, area, width - LEFT - RIGHT)?;
    let top = CAPTION + legend;
    let plot = (width - LEFT - RIGHT, height.saturating_sub(top + BELOW).max(10));
    let (x, y) = axes(panel, plot);
    let named = |name: &str, axis: &Axis| match axis.factor() {
        // The factor belongs in front of the unit: `e (1e-6 m)`.
        Some(factor) => match name.rsplit_once('(') {
            Some((quantity, unit)) => format!("{quantity}({factor} {unit}"),
            None => format!("{name} ({factor})"),
        },
        None => name.to_string(),
    };
    let (x_name, y_name) = (named(&panel.x, &x), named(&panel.y, &y));
    let mut chart = ChartBuilder::on(area)
        .margin_top(top)
        .margin_right(RIGHT)
        .margin_left(MARGIN)
        .margin_bottom(0)
        .x_label_area_size(BELOW)
        .y_label_area_size(LEFT - MARGIN)
        .build_cartesian_2d(x, y)?;
    chart.configure_mesh().disable_axes().bold_line_style(RGBColor(222, 222, 222)).light_line_style(TRANSPARENT).draw()?;
    for series in &panel.series {
        draw_series(&mut chart, series, panel.scale, plot.0)?;
    }
    chart
        .configure_mesh()
        .disable_mesh()
        .x_desc(x_name)
        .y_desc(y_name)
        .axis_style(RGBColor(60, 60, 60))
        .label_style((FONT, 13).into_font().color(&BLACK))
        .axis_desc_style((FONT, 14).into_font().color(&BLACK))
        .draw()?;
    Ok(())
}

/// The names of the series above the chart, in as many lines as they need; returns the height used.
fn legend(panel: &Panel, area: &Area<'_>, width: u32) -> Result<u32, DrawingAreaErrorKind<std::io::Error>> {
    let named: Vec<&Series> = panel.series.iter().filter(|series| !series.name.is_empty()).collect();
    if named.is_empty() {
        return Ok(0);
    }
    let size = |series: &Series| 34.0 + series.name.chars().count() as f64 * LETTER + 14.0;
    let mut lines: Vec<Vec<&Series>> = vec![Vec::new()];
    let mut used = 0.0;
    for series in named {
        if used + size(series) > f64::from(width) && used > 0.0 {
            lines.push(Vec::new());
            used = 0.0;
        }
        used += size(series);
        lines.last_mut().expect("there is a line").push(series);
    }
    let text = (FONT, 13).into_font().color(&BLACK).pos(Pos::new(HPos::Left, VPos::Center));
    for (i, line) in lines.iter().enumerate() {
        let total: f64 = line.iter().map(|series| size(series)).sum();
        let mut x = f64::from(LEFT) + ((f64::from(width) - total) / 2.0).max(0.0);
        let y = (CAPTION + i as u32 * LEGEND_LINE + LEGEND_LINE / 2) as i32;
        for series in line {
            let colour = PALETTE[series.colour % PALETTE.len()];
            let (from, to) = (x as i32, x as i32 + 26);
            match series.style {
                Style::Line => area.draw(&PathElement::new(vec![(from, y), (to, y)], colour.stroke_width(2)))?,
                Style::Dashed => {
                    for k in 0..3 {
                        area.draw(&PathElement::new(vec![(from + 10 * k, y), (from + 10 * k + 6, y)], colour.stroke_width(2)))?;
                    }
                }
                Style::Marks => area.draw(&Circle::new(((from + to) / 2, y), 4, colour.filled()))?,
            }
            area.draw(&Text::new(series.name.clone(), (to + 6, y), text.clone()))?;
            x += size(series);
        }
    }
    Ok(lines.len() as u32 * LEGEND_LINE + 6)
}

fn axes(panel: &Panel, (width, height): (u32, u32)) -> (Axis, Axis) {
    let points = || panel.series.iter().flat_map(|series| &series.points).filter(|(x, y)| x.is_finite() && y.is_finite());
    let bounds = |values: &mut dyn Iterator<Item = f64>| {
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    };
    let (x, y) = (bounds(&mut points().map(|p| p.0)), bounds(&mut points().map(|p| p.1)));
    match panel.scale {
        Scale::Linear => (Axis::linear(x.0, x.1, 0.0), Axis::linear(y.0, y.1, 0.05)),
        Scale::Logarithmic => {
            let sizes = bounds(&mut points().map(|p| p.1.abs()).filter(|size| *size > 0.0));
            let (low, high) = if sizes.0 > sizes.1 { (0.1, 1.0) } else { sizes };
            // What is smaller than a trillionth of the largest is rounding.
            (Axis::linear(x.0, x.1, 0.0), Axis::decades(low.max(high * 1e-12).log10(), high.log10()))
        }
        Scale::Equal => {
            let (x, y) = (Axis::linear(x.0, x.1, 0.06).bounds(), Axis::linear(y.0, y.1, 0.06).bounds());
            let unit = ((x.1 - x.0) / f64::from(width)).max((y.1 - y.0) / f64::from(height));
            let about = |(low, high): (f64, f64), pixels: u32| {
                let (middle, half) = ((low + high) / 2.0, unit * f64::from(pixels) / 2.0);
                Axis::widened(middle - half, middle + half)
            };
            (about(x, width), about(y, height))
        }
    }
}

fn draw_series<'a>(chart: &mut Chart<'a>, series: &Series, scale: Scale, width: u32) -> Drawn {
    let colour = PALETTE[series.colour % PALETTE.len()];
    let points: Vec<(f64, f64)> = series
        .points
        .iter()
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .filter_map(|&(x, y)| match scale {
            Scale::Logarithmic => (y != 0.0).then(|| (x, y.abs().log10())),
            _ => Some((x, y)),
        })
        .collect();
    match series.style {
        Style::Line => {
            chart.draw_series(LineSeries::new(thinned(&points, scale, width), colour.stroke_width(2)))?;
        }
        Style::Dashed => {
            chart.draw_series(DashedLineSeries::new(thinned(&points, scale, width), 6, 4, colour.stroke_width(2)))?;
        }
        Style::Marks => {
            chart.draw_series(points.iter().map(|&point| Circle::new(point, 4, colour.filled())))?;
        }
    }
    Ok(())
}

/// A line of no more points than can be told apart: of functions of time the lowest and the highest in each column of pixels, of curves
/// the points that are not in line with their neighbours.
fn thinned(points: &[(f64, f64)], scale: Scale, width: u32) -> Vec<(f64, f64)> {
    let columns = width as usize * 2;
    if points.len() <= columns {
        return points.to_vec();
    }
    let size = points.len().div_ceil(columns);
    if scale == Scale::Equal {
        return points.iter().step_by(size).chain(points.last()).copied().collect();
    }
    let mut kept = Vec::with_capacity(2 * columns + 1);
    for chunk in points.chunks(size) {
        let at = |better: fn(f64, f64) -> bool| {
            (1..chunk.len()).fold(0, |best, i| if better(chunk[i].1, chunk[best].1) { i } else { best })
        };
        let (low, high) = (at(|a, b| a < b), at(|a, b| a > b));
        kept.push(chunk[low.min(high)]);
        if low != high {
            kept.push(chunk[low.max(high)]);
        }
    }
    kept.extend(points.last());
    kept
}
