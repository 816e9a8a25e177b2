//! Mass distributions of geometries, as MuJoCo computes them where a body has no `inertial`: each shape by its mass, or by its volume and
//! density; all of them exactly, up to roots of lengths and pi.
//!
//! With half sizes a, b, c, a radius r and a half length l along z, about the centre:
//!
//! ```text
//! box        V = 8abc            Ixx = m (b² + c²)/3          Iyy, Izz likewise
//! ellipsoid  V = 4/3 pi abc      Ixx = m (b² + c²)/5          Iyy, Izz likewise
//! sphere     V = 4/3 pi r³       Ixx = Iyy = Izz = 2/5 m r²
//! cylinder   V = 2 pi r² l       Ixx = Iyy = m (3r² + 4l²)/12, Izz = m r²/2
//! capsule    a cylinder and, beyond its ends, two half balls, which together weigh s = m 4r/(4r + 6l):
//!            Ixx = Iyy = (m - s)(3r² + 4l²)/12 + s (2/5 r² + l² + 3/4 r l),   Izz = (m - s) r²/2 + 2/5 s r²
//! ```
//!
//! The centre of a half ball lies 3/8 r beyond its plane: l² + 3/4 r l is what the displacement of both adds.

use armgen_codegen::exact::{Number, Rational};
use armgen_codegen::source::Span;
use roxmltree::Node;

use super::classes::{around, Element};
use super::turns::z_axis;
use super::{FromGeometries, Mjcf};
use crate::body::Body;
use crate::format::Part;
use crate::number::{ending, Decimal};
use crate::pose::{nothing, Pose, Turn};
use crate::values::Values;
use crate::written::Written;
use crate::xml::{attribute, child, place, shown};
use crate::Code;

/// Density where none is given, kg/m³.
const DENSITY: &str = "1000";

/// Shapes whose mass distribution has a formula, and how many sizes each has, with `fromto` and without.
const SHAPES: [(&str, usize, usize); 5] =
    [("sphere", 1, 1), ("capsule", 1, 2), ("cylinder", 1, 2), ("box", 1, 3), ("ellipsoid", 1, 3)];

impl<'a, 'i> Mjcf<'a, 'i> {
    /// The geometries of a body whose groups take part in its inertia.
    fn selected(&self, body: Node<'a, 'i>) -> Vec<Element<'a, 'i>> {
        let (mut found, mut open) = (Vec::new(), vec![body]);
        while let Some(node) = open.pop() {
            for inner in node.children().filter(Node::is_element) {
                match inner.tag_name().name() {
                    "frame" => open.push(inner),
                    "geom" => found.push(Element { node: inner, class: around(inner) }),
                    _ => {}
                }
            }
        }
        found.sort_by_key(|element| element.node.range().start);
        found.retain(|&element| {
            let group = self.plain(element, "group").unwrap_or(0.0) as i64;
            (self.compiler.groups[0]..=self.compiler.groups[1]).contains(&group)
        });
        found
    }

    /// A number of an element for a question, not for the arm.
    fn plain(&self, element: Element<'a, 'i>, name: &str) -> Option<f64> {
        self.classes.attribute(element, name).and_then(|(word, _)| word.trim().parse().ok())
    }

    /// The geometries that give a body its inertia; none where its `inertial` does.
    fn made_of(&self, body: Node<'a, 'i>) -> Vec<Element<'a, 'i>> {
        let given = child(body, "inertial").is_some();
        if self.compiler.from_geometries == FromGeometries::Never
            || (given && self.compiler.from_geometries == FromGeometries::Auto)
        {
            return Vec::new();
        }
        let mut found = self.selected(body);
        found.retain(|&element| self.plain(element, "mass").or(self.plain(element, "density")) != Some(0.0));
        found
    }

    /// The `inertial` of a body, where it holds.
    pub(super) fn inertial(&self, body: Node<'a, 'i>) -> Option<Node<'a, 'i>> {
        let replaced = self.compiler.from_geometries == FromGeometries::Always && !self.made_of(body).is_empty();
        child(body, "inertial").filter(|_| !replaced)
    }

    /// The kind of the first geometry of a body's inertia whose mass distribution has no formula.
    pub(super) fn without_formula(&self, body: Node<'a, 'i>) -> Option<String> {
        self.made_of(body).into_iter().find_map(|element| {
            let kind = self.kind_of_geometry(element);
            let shell = self.classes.attribute(element, "shellinertia").is_some_and(|(word, _)| word == "true");
            let fitted = self.classes.attribute(element, "mesh").is_some();
            match SHAPES.iter().any(|(name, ..)| *name == kind) {
                true if shell => Some(format!("a `{kind}` with `shellinertia`")),
                true if fitted => Some(format!("a `{kind}` that is fitted to a mesh")),
                true => None,
                false => Some(format!("a `{}`", shown(kind))),
            }
        })
    }

    fn kind_of_geometry(&self, element: Element<'a, 'i>) -> &'a str {
        let meshed = self.classes.attribute(element, "mesh").is_some();
        self.classes.attribute(element, "type").map_or(if meshed { "mesh" } else { "sphere" }, |(word, _)| word)
    }

    /// Whether a body takes its inertia from geometries.
    pub(super) fn is_of_geometries(&self, body: Node<'a, 'i>) -> bool {
        !self.made_of(body).is_empty()
    }

    /// The mass distributions of a body's geometries; faults are reported.
    pub(super) fn of_geometries(&self, body: Node<'a, 'i>, values: &mut Values<'_>) -> Vec<Part> {
        let found = self.made_of(body);
        let called = attribute(body, "name").map_or("body", |(name, _)| name);
        let parts = found.into_iter().enumerate().filter_map(|(k, element)| {
            let own = attribute(element.node, "name").map(|(name, _)| name.to_owned());
            let name = own.unwrap_or_else(|| format!("{called}_geom_{}", k + 1));
            self.of_geometry(element, body, name, values)
        });
        parts.collect()
    }

    fn of_geometry(&self, element: Element<'a, 'i>, body: Node<'a, 'i>, name: String, values: &mut Values<'_>) -> Option<Part> {
        let span = place(element.node);
        let kind = self.kind_of_geometry(element);
        let &(_, with_ends, without) = SHAPES.iter().find(|(name, ..)| *name == kind)?;
        let ends = self.classes.attribute(element, "fromto").filter(|_| kind != "sphere");
        let mut frame = self.frames_around(element.node, body, values);
        let what = format!("the geometry `{}`", shown(&name));
        let (text, at) = self.classes.attribute(element, "size").or_else(|| {
            values.report(Code::MissingAttribute, span, format!("{what} has no size"), "", "write `size=\"0.05\"` in it");
            None
        })?;
        let given = values.words(text, at, &what);
        let needed = if ends.is_some() { with_ends } else { without };
        if given.len() < needed {
            let message = format!("{what} has {} of {needed} sizes", given.len());
            values.report(Code::WrongLength, at, message, "", format!("a `{kind}` has half sizes, in m: write {needed}"));
            return None;
        }
        if let Some(size) = given[..needed].iter().find(|size| size.value <= 0.0) {
            let message = format!("{what} has the size {}", size.text);
            values.report(Code::MjcfFeature, size.span, message, "", "a size is above 0");
            return None;
        }
        let mut sizes: Vec<Number> = given[..needed].iter().map(Decimal::exact).collect();
        let (com, turns) = match ends {
            None => {
                let mut poses = self.pose(element, &what, values);
                let first = poses.remove(0);
                (first.xyz, std::iter::once(first.turn).chain(poses.into_iter().map(|pose| pose.turn)).collect::<Vec<_>>())
            }
            Some((text, at)) => {
                let numbers = values.list::<6>(text, at, "fromto", &what)?;
                let (half, centre, turn) = between(&numbers, at, &what, values)?;
                sizes.truncate(1);
                if matches!(kind, "box" | "ellipsoid") {
                    sizes.push(sizes[0].clone());
                }
                sizes.push(half);
                (centre, vec![turn])
            }
        };
        let mass = self.mass_of(element, kind, &sizes, &what, values)?;
        let [xx, yy, zz] = moments(kind, &sizes, &mass);
        let holds =
            |number: &Number| number.is_zero() || number.to_f64().abs() >= f64::MIN_POSITIVE && number.to_f64().is_finite();
        if ![&mass, &xx, &yy, &zz].into_iter().all(holds) {
            let help = "look for a length, mass or density of an unlikely size: SI units throughout";
            values.report(Code::OutOfRange, span, format!("{what} has a mass or an inertia that no float can hold"), "", help);
            return None;
        }
        let zero = Written::zero;
        let inertia = [&xx, &yy, &zz].map(|moment| Written::as_is(&as_decimal(moment, span)).inexact());
        let [xx, yy, zz] = inertia;
        let inertia = [xx, yy, zz, zero(), zero(), zero()];
        // A tensor takes one rotation; more are poses of a frame.
        let (com, turn) = match &turns[..] {
            [only] => (com, only.clone()),
            _ => {
                let mut com = Some(com);
                let steps = turns.into_iter().map(|turn| Pose { xyz: com.take().unwrap_or_else(nothing), turn });
                frame.extend(steps);
                (nothing(), Turn::none())
            }
        };
        let body = Body { mass: as_decimal(&mass, span), com, inertia, turn };
        Some(Part { name: Some(name), frame, body })
    }

    /// The poses of the frames between a body and an element in it.
    fn frames_around(&self, node: Node<'a, 'i>, body: Node<'a, 'i>, values: &mut Values<'_>) -> Vec<Pose> {
        let mut frames: Vec<Node<'a, 'i>> = node.ancestors().skip(1).take_while(|outer| *outer != body).collect();
        frames.reverse();
        frames.into_iter().flat_map(|node| self.pose(Element { node, class: None }, "the pose of a frame", values)).collect()
    }

    fn mass_of(
        &self,
        element: Element<'a, 'i>,
        kind: &str,
        sizes: &[Number],
        what: &str,
        values: &mut Values<'_>,
    ) -> Option<Number> {
        let mass = self.number(element, "mass", &format!("the mass of {what}"), values);
        let density = self.number(element, "density", &format!("the density of {what}"), values);
        let given = [&mass, &density].into_iter().flatten().next();
        if let Some(given) = given.filter(|given| given.value < 0.0) {
            let message = format!("{what} has a negative mass or density: {}", given.text);
            values.report(Code::NegativeMass, given.span, message, "", "a mass is at least 0");
            return None;
        }
        if let Some(mass) = mass {
            return Some(mass.exact());
        }
        let density = density.map_or_else(|| crate::number::exact(DENSITY), |density| density.exact());
        Some(&density * &volume(kind, sizes))
    }
}

fn fraction(numerator: i64, denominator: i64) -> Number {
    Number::from(Rational::from(numerator) / Rational::from(denominator))
}

fn square(x: &Number) -> Number {
    x * x
}

fn volume(kind: &str, sizes: &[Number]) -> Number {
    let product = |numbers: &[&Number]| numbers.iter().fold(Number::one(), |all, x| &all * x);
    let pi = Number::pi();
    match (kind, sizes) {
        ("box", [a, b, c]) => product(&[&fraction(8, 1), a, b, c]),
        ("ellipsoid", [a, b, c]) => product(&[&fraction(4, 3), &pi, a, b, c]),
        ("cylinder", [r, l]) => product(&[&fraction(2, 1), &pi, r, r, l]),
        ("capsule", [r, l]) => &product(&[&fraction(2, 1), &pi, r, r, l]) + &product(&[&fraction(4, 3), &pi, r, r, r]),
        (_, [r, ..]) => product(&[&fraction(4, 3), &pi, r, r, r]),
        _ => Number::zero(),
    }
}

/// The principal moments about the centre.
fn moments(kind: &str, sizes: &[Number], mass: &Number) -> [Number; 3] {
    let cuboid = |a: &Number, b: &Number, c: &Number, part: &Number| {
        let of = |x: &Number, y: &Number| &(mass * part) * &(&square(x) + &square(y));
        [of(b, c), of(a, c), of(a, b)]
    };
    // A cylinder's moment across it over its mass.
    let across = |r: &Number, l: &Number| &(&fraction(1, 4) * &square(r)) + &(&fraction(1, 3) * &square(l));
    match (kind, sizes) {
        ("box", [a, b, c]) => cuboid(a, b, c, &fraction(1, 3)),
        ("ellipsoid", [a, b, c]) => cuboid(a, b, c, &fraction(1, 5)),
        ("cylinder", [r, l]) => {
            let x = mass * &across(r, l);
            [x.clone(), x, &(mass * &fraction(1, 2)) * &square(r)]
        }
        ("capsule", [r, l]) => {
            let whole = &(&fraction(4, 1) * r) + &(&fraction(6, 1) * l);
            let part = (&fraction(4, 1) * r).checked_div(&whole).unwrap_or_else(Number::zero);
            let balls = mass * &part;
            let rest = mass - &balls;
            let beyond = &square(l) + &(&fraction(3, 4) * &(r * l));
            let ball = &fraction(2, 5) * &square(r);
            let x = &(&rest * &across(r, l)) + &(&balls * &(&ball + &beyond));
            let z = &(&(&rest * &fraction(1, 2)) * &square(r)) + &(&balls * &ball);
            [x.clone(), x, z]
        }
        (_, [r, ..]) => {
            let x = &(mass * &fraction(2, 5)) * &square(r);
            [x.clone(), x.clone(), x]
        }
        _ => [Number::zero(), Number::zero(), Number::zero()],
    }
}

/// Half the distance of two points, their centre, and a turn of z to their direction.
fn between(ends: &[Decimal; 6], span: Span, what: &str, values: &mut Values<'_>) -> Option<(Number, [Written; 3], Turn)> {
    let exact = ends.each_ref().map(Decimal::exact);
    let half = fraction(1, 2);
    let along: [Number; 3] = std::array::from_fn(|k| &exact[k + 3] - &exact[k]);
    let length = (0..3).fold(Number::zero(), |sum, k| &sum + &square(&along[k])).sqrt()?;
    let centre: [Written; 3] = std::array::from_fn(|k| {
        let middle = as_decimal(&(&half * &(&exact[k] + &exact[k + 3])), ends[k].span);
        Written::as_is(&middle)
    });
    let along = along.each_ref().map(|x| as_decimal(x, span));
    let (direction, offset) = values.direction(&along, span, &format!("`fromto` of {what}"))?;
    Some((&half * &length, centre, z_axis(direction, offset, span)))
}

/// A number as robot.yaml writes it.
fn as_decimal(number: &Number, span: Span) -> Decimal {
    let text = number.as_rational().and_then(ending).unwrap_or_else(|| number.to_string());
    Decimal { text, value: number.to_f64(), span }
}
