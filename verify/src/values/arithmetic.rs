//! The numbers in which programs and equations are executed.
//!
//! | arithmetic | elements | what an equality there says |
//! |---|---|---|
//! | [`prime`] | integers modulo a random prime of 62 bits | equal but for odds of about (degree)/p |
//! | [`tower`] | fractions, with the square roots that the robot needs adjoined | equal at that point, beyond doubt |
//! | [`dual`] | pairs value + derivative over either | derivatives along a direction |
//! | [`wide`] | floats of 256 bits | nothing: they measure rounding errors, and prove none |
//! | [`twofold`] | pairs of floats in lanes, 106 bits | nothing: the same, for millions of states |
//! | [`running`] | floats in lanes with their error bounds | nothing: how well floats can compute the equations |
//! | [`degree`] | degree and height of the polynomial that a value is | how unlikely a false equality is |
//!
//! Angles are random points of the circle: (s, c) = (2t, 1 - t²)/(1 + t²). Pi, and sine and cosine of angles that have no roots, take
//! random values too, each (sine, cosine) on the circle: what holds for all such values holds for the true ones.

pub mod degree;
pub mod dual;
pub mod plain;
pub mod prime;
pub mod roots;
pub mod running;
pub mod tower;
pub mod twofold;
pub mod wide;

use crate::values::element::Element;
use crate::values::formula::Formula;

/// Where elements come from.
pub trait Arithmetic {
    /// Its numbers.
    type Element: Element;
    /// An integer.
    fn integer(&self, value: i64) -> Self::Element;
    /// The value of an exact constant; `None` where it divides by 0.
    fn constant(&self, formula: &Formula) -> Option<Self::Element>;
    /// A coordinate of a unit vector of the description. Floats round it at the length of the vector: an axis that is turned by nearly pi has
    /// coordinates of 1e-16, which no product of its rotations knows better.
    fn coordinate(&self, formula: &Formula) -> Option<Self::Element> {
        self.constant(formula)
    }
    /// A random element, not 0.
    fn draw(&mut self) -> Self::Element;
    /// A random point of the circle: sine and cosine.
    fn draw_angle(&mut self) -> (Self::Element, Self::Element) {
        loop {
            let (t, one) = (self.draw(), self.integer(1));
            let square = t.times(&t);
            if let Some(scale) = one.plus(&square).inverse() {
                return (t.plus(&t).times(&scale), one.minus(&square).times(&scale));
            }
        }
    }
}

impl<A: Arithmetic + ?Sized> Arithmetic for &mut A {
    type Element = A::Element;

    fn integer(&self, value: i64) -> A::Element {
        (**self).integer(value)
    }

    fn constant(&self, formula: &Formula) -> Option<A::Element> {
        (**self).constant(formula)
    }

    fn coordinate(&self, formula: &Formula) -> Option<A::Element> {
        (**self).coordinate(formula)
    }

    fn draw(&mut self) -> A::Element {
        (**self).draw()
    }

    fn draw_angle(&mut self) -> (A::Element, A::Element) {
        (**self).draw_angle()
    }
}
