//! Labels near points, placed to hide as little as possible of curves, points and each other.
//!
//! Each label in turn takes the best of a few places around its point. The best box covers the least length of curves, no other point,
//! and no earlier label.

use super::svg::Anchor;

/// A rectangle: left, top, right, bottom; pixels, y downwards.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rectangle {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

impl Rectangle {
    fn holds(&self, (x, y): (f64, f64)) -> bool {
        (self.left..self.right).contains(&x) && (self.top..self.bottom).contains(&y)
    }

    fn meets(&self, other: &Rectangle) -> bool {
        self.left < other.right && other.left < self.right && self.top < other.bottom && other.top < self.bottom
    }

    fn lies_in(&self, other: &Rectangle) -> bool {
        self.left >= other.left && self.right <= other.right && self.top >= other.top && self.bottom <= other.bottom
    }

    /// The length of a line within it (Liang and Barsky).
    fn length_within(&self, (a, b): ((f64, f64), (f64, f64))) -> f64 {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut enters, mut leaves) = (0.0f64, 1.0f64);
        for (rate, distance) in [(-dx, a.0 - self.left), (dx, self.right - a.0), (-dy, a.1 - self.top), (dy, self.bottom - a.1)] {
            if rate == 0.0 {
                if distance < 0.0 {
                    return 0.0;
                }
            } else if rate < 0.0 {
                enters = enters.max(distance / rate);
            } else {
                leaves = leaves.min(distance / rate);
            }
        }
        (leaves - enters).max(0.0) * dx.hypot(dy)
    }
}

/// Place of a label: the point of its anchor, on its baseline.
pub(super) type Place = ((f64, f64), Anchor);

/// The places of labels near these points; `texts` are their widths, `curves` the lines to keep visible, `area` their bounds.
pub(super) fn place(
    points: &[(f64, f64)],
    widths: &[f64],
    size: f64,
    curves: &[Vec<(f64, f64)>],
    (x, y, w, h): (f64, f64, f64, f64),
) -> Vec<Place> {
    let area = Rectangle { left: x, top: y, right: x + w, bottom: y + h };
    let mut taken: Vec<Rectangle> = Vec::new();
    let mut places = Vec::new();
    for (i, (point, width)) in points.iter().zip(widths).enumerate() {
        let cost = |(at, anchor): &Place| {
            let rectangle = rectangle(*at, *anchor, *width, size);
            let hidden: f64 =
                curves.iter().flat_map(|curve| curve.windows(2)).map(|line| rectangle.length_within((line[0], line[1]))).sum();
            let over = taken.iter().filter(|other| rectangle.meets(other)).count() as f64;
            let dots = points.iter().enumerate().filter(|(k, dot)| *k != i && rectangle.holds(**dot)).count() as f64;
            hidden + 100.0 * (over + dots) + if rectangle.lies_in(&area) { 0.0 } else { 1000.0 }
        };
        // Of equally good places, the first.
        let best =
            candidates(*point, size).map(|place| (cost(&place), place)).into_iter().reduce(|a, b| if b.0 < a.0 { b } else { a });
        let (at, anchor) = best.map_or((*point, Anchor::Start), |(_, place)| place);
        taken.push(rectangle(at, anchor, *width, size));
        places.push((at, anchor));
    }
    places
}

fn rectangle((x, y): (f64, f64), anchor: Anchor, width: f64, size: f64) -> Rectangle {
    let left = match anchor {
        Anchor::Start => x,
        Anchor::Middle => x - width / 2.0,
        Anchor::End => x - width,
    };
    Rectangle { left: left - 1.5, top: y - 0.8 * size - 1.5, right: left + width + 1.5, bottom: y + 0.25 * size + 1.5 }
}

/// Places around a point, in order of preference.
fn candidates((x, y): (f64, f64), size: f64) -> [Place; 12] {
    use Anchor::{End, Middle, Start};
    let down = 0.8 * size;
    let at = |dx: f64, dy: f64, anchor: Anchor| ((x + dx, y + dy), anchor);
    [
        at(5.0, -5.0, Start),
        at(-5.0, -5.0, End),
        at(5.0, 5.0 + down, Start),
        at(-5.0, 5.0 + down, End),
        at(7.0, 0.35 * size, Start),
        at(-7.0, 0.35 * size, End),
        at(0.0, -7.0, Middle),
        at(0.0, 7.0 + down, Middle),
        at(12.0, -12.0, Start),
        at(-12.0, -12.0, End),
        at(12.0, 12.0 + down, Start),
        at(-12.0, 12.0 + down, End),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    const AREA: (f64, f64, f64, f64) = (0.0, 0.0, 200.0, 200.0);

    /// The place of a single label near (100, 100).
    fn beside(curves: &[Vec<(f64, f64)>], others: &[(f64, f64)]) -> Place {
        let points: Vec<(f64, f64)> = [&[(100.0, 100.0)], others].concat();
        place(&points, &vec![20.0; points.len()], 10.0, curves, AREA)[0]
    }

    #[test]
    fn a_text_keeps_off_curves_points_and_edges() {
        let ((x, y), anchor) = beside(&[], &[]);
        assert!(x > 100.0 && y < 100.0 && anchor == Anchor::Start, "to the right and above where nothing is in the way");
        // The curve goes up and to the right.
        let ((x, _), anchor) = beside(&[vec![(100.0, 100.0), (150.0, 60.0)]], &[]);
        assert!(x < 100.0 && anchor == Anchor::End);
        // A curve above on both sides, and another point below on the right.
        let curves = [vec![(50.0, 90.0), (150.0, 90.0)]];
        let ((x, y), _) = beside(&curves, &[(115.0, 110.0)]);
        assert!(x < 100.0 && y > 100.0);
        let at_the_edge = place(&[(195.0, 5.0)], &[20.0], 10.0, &[], AREA)[0];
        assert!(at_the_edge.0 .0 < 195.0 && at_the_edge.0 .1 > 5.0, "{at_the_edge:?}");
    }

    #[test]
    fn texts_of_points_at_one_place_stand_apart() {
        let points = [(100.0, 100.0), (104.0, 100.0), (100.0, 104.0)];
        let places = place(&points, &[20.0; 3], 10.0, &[], AREA);
        let boxes: Vec<Rectangle> = places.iter().map(|(at, anchor)| rectangle(*at, *anchor, 20.0, 10.0)).collect();
        assert!(!boxes[0].meets(&boxes[1]) && !boxes[0].meets(&boxes[2]) && !boxes[1].meets(&boxes[2]));
    }

    #[test]
    fn lengths_within_a_rectangle() {
        let r = Rectangle { left: 0.0, top: 0.0, right: 10.0, bottom: 10.0 };
        for (line, length) in [
            (((-5.0, 5.0), (15.0, 5.0)), 10.0),
            (((5.0, 5.0), (5.0, 50.0)), 5.0),
            (((-5.0, -5.0), (-5.0, 15.0)), 0.0),
            (((0.0, 0.0), (10.0, 10.0)), 200f64.sqrt()),
            (((2.0, 2.0), (2.0, 2.0)), 0.0),
        ] {
            assert!((r.length_within(line) - length).abs() < 1e-12, "{line:?}");
        }
    }
}
