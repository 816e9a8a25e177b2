//! The bodies of an arm: mass, centre of mass, and the cuboid of uniform density that has the same inertia.
//!
//! A cuboid with edges a, b, c along its principal axes has I1 = m (b² + c²)/12, and I2 and I3 by permutation. Therefore
//!
//! ```text
//! a² = 6 (I2 + I3 - I1) / m
//! ```
//!
//! A negative a² shows a tensor that no body has. The script computes the eigenvalues, because it draws the cuboid;
//! this module only collects the numbers.

use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::description::{BodyDescription, RobotDescription};
use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::manipulator::{Manipulator, PlacedBody};
use armgen_codegen::validate::{density_of_cuboid, doubt_of_density};
use serde_json::{json, Value};

use crate::rows::frame;

/// The bodies of all links, and the payload, which is given in the frame of the end effector.
/// Each has its name, carrying frame (from 1, or `e`), mass, centre of mass and inertia tensor (xx xy yy xz yz zz).
/// `doubt` describes an unlikely density of its cuboid; `said` lists the messages about its tensor.
pub(crate) fn bodies(manipulator: &Manipulator, description: &RobotDescription, diagnostics: &Diagnostics) -> Value {
    let of = |name: String, carrier: Value, part: &PlacedBody, written: Option<&BodyDescription>| {
        let number = |p: &_| nominal(manipulator, p).to_f64();
        let (mass, inertia) = (number(&part.body.mass), part.body.inertia.each_ref().map(number));
        json!({
            "name": name,
            "frame": carrier,
            "mass": mass,
            "com": part.body.com.each_ref().map(number),
            "inertia": inertia,
            "doubt": density_of_cuboid(mass, inertia).and_then(doubt_of_density),
            "said": said(written, diagnostics),
        })
    };
    let mut all = Vec::new();
    let written = description.joints.iter().flat_map(|joints| &joints.value);
    for (i, (joint, row)) in manipulator.joints.iter().zip(written).enumerate() {
        let link = row.link.as_ref();
        let mut written = link.into_iter().chain(link.into_iter().flat_map(|link| link.attached.iter().map(|other| &other.body)));
        for (k, part) in joint.link.iter().enumerate() {
            let name = if k == 0 { joint.name.clone() } else { format!("{} + {k}", joint.name) };
            all.push(of(name, json!(i + 1), part, written.next()));
        }
    }
    if let Some(payload) = &manipulator.payload {
        let of_tip = description.tips.iter().flat_map(|tips| &tips.value).next().and_then(|tip| tip.payload.as_ref());
        all.push(of("payload".into(), json!("e"), payload, description.payload.as_ref().or(of_tip)));
    }
    Value::Array(all)
}

/// The messages about the inertia tensor of a body.
fn said<'d>(written: Option<&BodyDescription>, diagnostics: &'d Diagnostics) -> Vec<&'d str> {
    let Some(inertia) = written.and_then(|body| body.inertia.as_ref()) else { return Vec::new() };
    let spans: Vec<_> =
        inertia.elements.iter().flatten().map(|element| element.span).chain(std::iter::once(inertia.key)).collect();
    let about = diagnostics.iter().filter(|diagnostic| diagnostic.labels.iter().any(|label| spans.contains(&label.span)));
    about.map(|diagnostic| diagnostic.message.as_str()).collect()
}

/// The pose of the end effector in the frame of the last link.
pub(crate) fn tool(manipulator: &Manipulator) -> Value {
    json!(frame(manipulator, &manipulator.tool.frame))
}

/// The named end effectors but the first one: their names, the links that carry them, from 0, and their frames there.
pub(crate) fn further_ends(manipulator: &Manipulator) -> Vec<Value> {
    let further = manipulator.tips.iter().skip(1);
    further.map(|tip| json!({ "name": tip.name, "link": tip.joint.0, "tool": frame(manipulator, &tip.tool.frame) })).collect()
}

/// Total mass of links and rotors, kg.
pub(crate) fn total_mass(manipulator: &Manipulator) -> f64 {
    let rotors = manipulator.joints.iter().filter_map(|joint| joint.motor.as_ref()).map(|motor| &motor.mass);
    let links = manipulator.joints.iter().flat_map(|joint| &joint.link).map(|part| &part.body.mass);
    links.chain(rotors).map(|mass| nominal(manipulator, mass).to_f64()).sum()
}
