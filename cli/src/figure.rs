//! Figures as SVG: charts in a grid, with labels, units and legends, readable in print and on a dark page.
//!
//! ```text
//! figure.rs        what a figure is: panels in rows, series in panels
//! figure/axis.rs   ranges and ticks
//! figure/draw.rs   from a figure to SVG
//! ```
//!
//! A panel with equal axes shows a metre as long upwards as sideways. Long series are thinned to what can be seen; a logarithmic axis shows
//! the size of its values. Every figure has a white ground of its own.

mod axis;
mod draw;

/// Panels in rows.
#[derive(Clone, Debug, Default)]
pub(crate) struct Figure {
    /// Above all panels.
    pub(crate) title: String,
    /// Rows of panels, from the top; panels of a row share its width in the proportion of their `width`.
    pub(crate) rows: Vec<Row>,
}

/// A row of panels.
#[derive(Clone, Debug, Default)]
pub(crate) struct Row {
    /// Height in pixels.
    pub(crate) height: u32,
    /// From the left.
    pub(crate) panels: Vec<Panel>,
}

/// One chart.
#[derive(Clone, Debug)]
pub(crate) struct Panel {
    /// Above the chart.
    pub(crate) title: String,
    /// Quantity and unit of the horizontal axis.
    pub(crate) x: String,
    /// Quantity and unit of the vertical axis.
    pub(crate) y: String,
    /// How the axes are scaled.
    pub(crate) scale: Scale,
    /// Width against the other panels of the row.
    pub(crate) width: f64,
    /// What is shown, the first at the bottom.
    pub(crate) series: Vec<Series>,
}

/// How the axes of a panel are scaled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    /// Both linear.
    Linear,
    /// Both linear, and a unit as long upwards as sideways.
    Equal,
    /// The vertical axis logarithmic, for the size of values.
    Logarithmic,
}

/// Points and how they are drawn.
#[derive(Clone, Debug)]
pub(crate) struct Series {
    /// In the legend; nothing there if empty.
    pub(crate) name: String,
    /// In order.
    pub(crate) points: Vec<(f64, f64)>,
    /// Line or marks.
    pub(crate) style: Style,
    /// Which of the colours.
    pub(crate) colour: usize,
}

/// How points are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Style {
    /// A line through them.
    Line,
    /// A broken line through them.
    Dashed,
    /// A disc at each.
    Marks,
}

/// Colours that differ for every kind of sight and in grey (Okabe, Ito, 2008).
pub(crate) const COLOURS: usize = draw::PALETTE.len();

impl Figure {
    /// A figure with this title.
    pub(crate) fn new(title: impl Into<String>) -> Figure {
        Figure { title: title.into(), rows: Vec::new() }
    }

    /// Adds a row.
    pub(crate) fn row(mut self, height: u32, panels: impl IntoIterator<Item = Panel>) -> Figure {
        self.rows.push(Row { height, panels: panels.into_iter().collect() });
        self
    }

    /// The figure as SVG text.
    pub(crate) fn svg(&self) -> String {
        draw::svg(self)
    }
}

impl Panel {
    /// An empty chart over these axes, each named with its unit.
    pub(crate) fn new(title: impl Into<String>, x: impl Into<String>, y: impl Into<String>, scale: Scale) -> Panel {
        Panel { title: title.into(), x: x.into(), y: y.into(), scale, width: 1.0, series: Vec::new() }
    }

    /// Adds a series in the next colour.
    pub(crate) fn line(self, name: impl Into<String>, points: impl IntoIterator<Item = (f64, f64)>) -> Panel {
        let colour = self.series.len() % COLOURS;
        self.series(name, points, Style::Line, colour)
    }

    /// Adds a series.
    pub(crate) fn series(
        mut self,
        name: impl Into<String>,
        points: impl IntoIterator<Item = (f64, f64)>,
        style: Style,
        colour: usize,
    ) -> Panel {
        self.series.push(Series { name: name.into(), points: points.into_iter().collect(), style, colour });
        self
    }
}
