//! A mass distribution, and what must hold for it.

use armgen_codegen::source::Span;
use armgen_codegen::validate::impossible_inertia;

use crate::number::Decimal;
use crate::pose::Turn;
use crate::values::Values;
use crate::written::Written;
use crate::Code;

/// A mass distribution in a frame.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) mass: Decimal,
    pub(crate) com: [Written; 3],
    /// xx yy zz xy xz yz, in turned axes.
    pub(crate) inertia: [Written; 6],
    pub(crate) turn: Turn,
}

/// Keys of robot.yaml in the order of [`Body::inertia`].
pub(crate) const ELEMENTS: [&str; 6] = ["xx", "yy", "zz", "xy", "xz", "yz"];

impl Values<'_> {
    /// The body of a mass and of six elements of a tensor that are `readable`; faults are reported at the places of mass and tensor.
    pub(crate) fn body(
        &mut self,
        called: &str,
        mass: Decimal,
        (com, turn): ([Written; 3], Turn),
        elements: &[Decimal; 6],
        readable: bool,
        tensor: Span,
    ) -> Body {
        if mass.value < 0.0 {
            let help = "a mass is at least 0";
            self.report(Code::NegativeMass, mass.span, format!("the mass of {called} is negative: {}", mass.text), "", help);
        }
        if readable {
            let [xx, yy, zz, xy, xz, yz] = elements.each_ref().map(Decimal::exact);
            if let Some(reason) = impossible_inertia(&[xx, xy, yy, xz, yz, zz]) {
                if self.inertia_as_written {
                    self.impossible.push(called.to_owned());
                    let message = format!("the inertia of {called} is impossible, and taken as written: {reason}");
                    let help = "B(q) may not be positive definite: no controller and no simulation is to be trusted with it";
                    self.report(Code::InertiaAsWritten, tensor, message, "", help);
                    return self.written_body(mass, com, turn, elements);
                }
                let message = format!("the inertia of {called} is impossible: {reason}");
                let help = "an inertia tensor about the centre of mass has no negative principal moment; ixy is the element -∫xy dm of the tensor, so check signs; `--inertia-as-written` takes it all the same";
                self.report(Code::ImpossibleInertia, tensor, message, "", help);
            }
        }
        self.written_body(mass, com, turn, elements)
    }

    fn written_body(&mut self, mass: Decimal, com: [Written; 3], turn: Turn, elements: &[Decimal; 6]) -> Body {
        let largest = elements[..3].iter().map(|x| x.value.abs()).fold(0.0, f64::max);
        let mut k = 0;
        let inertia = elements.each_ref().map(|element| {
            k += 1;
            if k <= 3 {
                Written::as_is(element)
            } else {
                self.snap.product(element, largest)
            }
        });
        Body { mass, com, inertia, turn }
    }
}
