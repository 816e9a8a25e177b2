//! `inertial` of a link.

use armgen_codegen::validate::impossible_inertia;
use roxmltree::Node;

use super::values::Values;
use crate::number::Decimal;
use crate::snap::Written;
use crate::xml::{attribute, child, place, shown};
use crate::Code;

/// A mass distribution in the frame of its link.
#[derive(Clone, Debug)]
pub(crate) struct Body {
    pub(crate) mass: Decimal,
    pub(crate) com: [Written; 3],
    /// xx yy zz xy xz yz, in axes turned by `rpy`.
    pub(crate) inertia: [Written; 6],
    pub(crate) rpy: [Written; 3],
}

/// Attributes of `inertia`, and the keys of robot.yaml, in the order of [`Body::inertia`].
pub(crate) const ELEMENTS: [(&str, &str); 6] =
    [("ixx", "xx"), ("iyy", "yy"), ("izz", "zz"), ("ixy", "xy"), ("ixz", "xz"), ("iyz", "yz")];

impl Values<'_> {
    /// The mass distribution of a link, if it has one; faults are reported.
    pub(crate) fn body(&mut self, link: Node<'_, '_>, name: &str) -> Option<Body> {
        let inertial = child(link, "inertial")?;
        let called = format!("the link `{}`", shown(name));
        let (com, rpy) = self.origin_of(inertial, &format!("the centre of mass of {called}"));
        let mass = self.required(inertial, "mass", "value=\"1\"")?;
        if attribute(mass, "value").is_none() {
            let help = "write `<mass value=\"1\"/>`";
            self.report(Code::MissingAttribute, place(mass), format!("the mass of {called} has no value"), "", help);
        }
        let mass = self.scalar(mass, "value", &format!("the mass of {called}"));
        let tensor = self.required(inertial, "inertia", "ixx=\"1\" ixy=\"0\" ixz=\"0\" iyy=\"1\" iyz=\"0\" izz=\"1\"")?;
        let missing: Vec<&str> =
            ELEMENTS.iter().map(|(name, _)| *name).filter(|name| attribute(tensor, name).is_none()).collect();
        if !missing.is_empty() {
            let message = format!("the inertia of {called} lacks {}, taken as 0", missing.join(", "));
            self.report(Code::MissingElementOfInertia, place(tensor), message, "", "write all six elements");
        }
        let before = self.diagnostics.errors();
        let elements =
            ELEMENTS.map(|(name, _)| self.scalar(tensor, name, &format!("`{name}` of {called}")).unwrap_or_else(Decimal::zero));
        let mass = mass?;
        if mass.value < 0.0 {
            let help = "a mass is at least 0";
            self.report(Code::NegativeMass, mass.span, format!("the mass of {called} is negative: {}", mass.text), "", help);
        }
        if self.diagnostics.errors() == before {
            let [xx, yy, zz, xy, xz, yz] = elements.each_ref().map(Decimal::exact);
            if let Some(reason) = impossible_inertia(&[xx, xy, yy, xz, yz, zz]) {
                let message = format!("the inertia of {called} is impossible: {reason}");
                let help = "an inertia tensor about the centre of mass has no negative principal moment; ixy is the element -∫xy dm of the tensor, so check signs";
                self.report(Code::ImpossibleInertia, place(tensor), message, "", help);
            }
        }
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
        Some(Body { mass, com, inertia, rpy })
    }

    fn required<'a, 'i>(&mut self, node: Node<'a, 'i>, name: &str, example: &str) -> Option<Node<'a, 'i>> {
        let found = child(node, name);
        if found.is_none() {
            let message = format!("`inertial` has no `{name}`");
            self.report(Code::MissingElement, place(node), message, "", format!("write `<{name} {example}/>` in it"));
        }
        found
    }
}
