//! A number of one of several arithmetics, told at run time.
//!
//! The equations are compiled once for each type that they are executed in: for integers modulo a prime, which most points are drawn in, and
//! for this one, which all other arithmetics share.

use crate::values::arithmetic::degree::Degree;
use crate::values::arithmetic::running::Running;
use crate::values::arithmetic::tower::Surd;
use crate::values::arithmetic::wide::Wide;
use crate::values::arithmetic::Arithmetic;
use crate::values::element::Element;
use crate::values::formula::Formula;
use crate::values::ranges::Range;

/// What a [`Number`] can be.
pub trait Member: Element {
    /// As a number.
    fn into_number(self) -> Number;
    /// Back from a number that was made of such ones.
    fn of(number: Number) -> Self;
}

macro_rules! members {
    ($($member:ident: $element:ty,)*) => {
        /// A number of an arithmetic that is told at run time. Those that meet come from one [`Erased`], and so are of one kind.
        #[derive(Clone, Debug, PartialEq)]
        #[allow(missing_docs)]
        pub enum Number {
            $($member($element),)*
        }

        $(impl Member for $element {
            fn into_number(self) -> Number {
                Number::$member(self)
            }
            fn of(number: Number) -> $element {
                match number {
                    Number::$member(element) => element,
                    _ => unreachable!("numbers of one arithmetic"),
                }
            }
        })*

        impl Element for Number {
            fn plus(&self, other: &Number) -> Number {
                match (self, other) {
                    $((Number::$member(a), Number::$member(b)) => Number::$member(a.plus(b)),)*
                    _ => unreachable!("numbers of one arithmetic"),
                }
            }
            fn minus(&self, other: &Number) -> Number {
                match (self, other) {
                    $((Number::$member(a), Number::$member(b)) => Number::$member(a.minus(b)),)*
                    _ => unreachable!("numbers of one arithmetic"),
                }
            }
            fn times(&self, other: &Number) -> Number {
                match (self, other) {
                    $((Number::$member(a), Number::$member(b)) => Number::$member(a.times(b)),)*
                    _ => unreachable!("numbers of one arithmetic"),
                }
            }
            fn over(&self, other: &Number) -> Option<Number> {
                match (self, other) {
                    $((Number::$member(a), Number::$member(b)) => a.over(b).map(Number::$member),)*
                    _ => unreachable!("numbers of one arithmetic"),
                }
            }
            fn negated(&self) -> Number {
                match self {
                    $(Number::$member(a) => Number::$member(a.negated()),)*
                }
            }
            fn inverse(&self) -> Option<Number> {
                match self {
                    $(Number::$member(a) => a.inverse().map(Number::$member),)*
                }
            }
            fn sign(&self) -> Number {
                match self {
                    $(Number::$member(a) => Number::$member(a.sign()),)*
                }
            }
            fn is_zero(&self) -> bool {
                match self {
                    $(Number::$member(a) => a.is_zero(),)*
                }
            }
            fn bits(&self) -> usize {
                match self {
                    $(Number::$member(a) => a.bits(),)*
                }
            }
        }
    };
}

members! {
    Float: f64,
    Wide: Wide,
    Degree: Degree,
    Surd: Surd,
    Range: Range,
    Running: Running,
}

/// An arithmetic whose elements are handed out as numbers.
pub struct Erased<K>(pub K);

/// Any of them.
pub type Numbers<'a> = &'a mut dyn Arithmetic<Element = Number>;

impl<K: Arithmetic> Arithmetic for Erased<K>
where
    K::Element: Member,
{
    type Element = Number;

    fn integer(&self, value: i64) -> Number {
        self.0.integer(value).into_number()
    }

    fn constant(&self, formula: &Formula) -> Option<Number> {
        self.0.constant(formula).map(Member::into_number)
    }

    fn coordinate(&self, formula: &Formula) -> Option<Number> {
        self.0.coordinate(formula).map(Member::into_number)
    }

    fn draw(&mut self) -> Number {
        self.0.draw().into_number()
    }

    fn draw_angle(&mut self) -> (Number, Number) {
        let (sine, cosine) = self.0.draw_angle();
        (sine.into_number(), cosine.into_number())
    }
}
