//! A figure as SVG text. A white page with dark ink is readable in print and on a dark page.
//!
//! Coordinates are pixels, y downwards, rounded to a tenth.

use std::fmt::Write;

/// Ink of texts and axes.
pub(super) const INK: &str = "#1a1a1a";
/// Ink of grids.
pub(super) const PALE: &str = "#d9d9d9";

/// A page to draw on.
pub(super) struct Svg {
    width: f64,
    height: f64,
    body: String,
    clips: usize,
}

/// The style of a line.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stroke {
    pub(super) colour: &'static str,
    pub(super) width: f64,
    /// Lengths of dashes and gaps; empty for a solid line.
    pub(super) dash: &'static str,
}

/// The position of a text relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A number without needless digits.
fn short(x: f64) -> String {
    let text = format!("{x:.1}");
    text.strip_suffix(".0").map_or(text.clone(), str::to_owned)
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

impl Svg {
    /// An empty page.
    pub(super) fn new(width: f64, height: f64) -> Svg {
        Svg { width, height, body: String::new(), clips: 0 }
    }

    fn push(&mut self, text: std::fmt::Arguments<'_>) {
        // A `String` accepts all text.
        let _ = self.body.write_fmt(text);
        self.body.push('\n');
    }

    /// A line through points; draws nothing for fewer than two.
    pub(super) fn line(&mut self, points: &[(f64, f64)], stroke: Stroke) {
        if points.len() < 2 {
            return;
        }
        let mut d = String::with_capacity(points.len() * 10);
        for (i, (x, y)) in points.iter().enumerate() {
            let _ = write!(d, "{}{} {}", if i == 0 { "M" } else { "L" }, short(*x), short(*y));
        }
        let dash = if stroke.dash.is_empty() { String::new() } else { format!(" stroke-dasharray=\"{}\"", stroke.dash) };
        self.push(format_args!(
            "<path d=\"{d}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{}\"{dash} stroke-linejoin=\"round\"/>",
            stroke.colour, stroke.width
        ));
    }

    /// A filled circle.
    pub(super) fn dot(&mut self, x: f64, y: f64, radius: f64, colour: &str) {
        self.push(format_args!("<circle cx=\"{}\" cy=\"{}\" r=\"{}\" fill=\"{colour}\"/>", short(x), short(y), short(radius)));
    }

    /// A rectangle's outline.
    pub(super) fn frame(&mut self, (x, y, w, h): (f64, f64, f64, f64)) {
        self.push(format_args!(
            "<rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"{INK}\"/>",
            short(x),
            short(y),
            short(w),
            short(h)
        ));
    }

    /// A text of this size; `upwards` rotates it by 90° counterclockwise.
    pub(super) fn text(&mut self, (x, y): (f64, f64), size: f64, anchor: Anchor, upwards: bool, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => " text-anchor=\"middle\"",
            Anchor::End => " text-anchor=\"end\"",
        };
        let turn = if upwards { format!(" transform=\"rotate(-90 {} {})\"", short(x), short(y)) } else { String::new() };
        self.push(format_args!(
            "<text x=\"{}\" y=\"{}\" font-size=\"{}\"{anchor}{turn}>{}</text>",
            short(x),
            short(y),
            short(size),
            escaped(text)
        ));
    }

    /// Clips the output of `draw` to a rectangle.
    pub(super) fn clipped(&mut self, (x, y, w, h): (f64, f64, f64, f64), draw: impl FnOnce(&mut Svg)) {
        self.clips += 1;
        let id = self.clips;
        self.push(format_args!(
            "<clipPath id=\"c{id}\"><rect x=\"{}\" y=\"{}\" width=\"{}\" height=\"{}\"/></clipPath><g clip-path=\"url(#c{id})\">",
            short(x),
            short(y),
            short(w),
            short(h)
        ));
        draw(self);
        self.push(format_args!("</g>"));
    }

    /// The whole figure.
    pub(super) fn text_of(self) -> String {
        let (w, h) = (short(self.width), short(self.height));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{w}\" height=\"{h}\" viewBox=\"0 0 {w} {h}\" \
             font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\" fill=\"{INK}\">\n\
             <rect width=\"{w}\" height=\"{h}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            self.body
        )
    }
}
