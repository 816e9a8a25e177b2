//! The rows of an arm as written, with the values of their names, and the limits and drives of its joints.

use armgen_codegen::derive::parameters::{denavit_hartenberg, nominal};
use armgen_codegen::description::{
    list_text, ClosureDescription, Convention, JointDescription, PoseDescription, RobotDescription, RotationDescription,
};
use armgen_codegen::exact::{Number, Polynomial};
use armgen_codegen::kinds::JointKind;
use armgen_codegen::manipulator::{Coordinate, Joint, JointVariable, Limits, Manipulator};
use armgen_codegen::source::{Source, Spanned};

use super::{decimal, digits};
use armgen_terminal::table::Align::{Left, Right};
use armgen_terminal::table::Table;

/// One line per joint: the row as written; and the poses before the first and after the last row.
pub(super) fn rows(source: &Source, description: &RobotDescription, manipulator: &Manipulator) -> String {
    let mut table = Table::new([
        ("joint", Left),
        ("type", Left),
        ("a (m)", Right),
        ("alpha (rad)", Right),
        ("d (m)", Right),
        ("theta (rad)", Right),
        ("origin", Left),
        ("axis", Left),
    ]);
    let written = description.joints.as_ref().map(|list| list.value.as_slice()).unwrap_or_default();
    let convention = description.convention.as_ref().map(|c| c.value);
    for (i, joint) in manipulator.joints.iter().enumerate() {
        let revolute = joint.kind == JointKind::Revolute;
        let ([a, alpha, d, theta], [origin, axis]) = match written.get(i) {
            None => Default::default(),
            Some(row) if convention == Some(Convention::Urdf) => (Default::default(), urdf_row(source, row)),
            Some(row) => (dh_row(source, row, i, manipulator, convention == Some(Convention::Modified)), Default::default()),
        };
        // A joint hangs on the one above, but for those that begin a branch.
        let on = match joint.parent.map(|parent| parent.index()) {
            parent if parent == i.checked_sub(1) => String::new(),
            parent => format!(", on {}", parent.map_or("the base", |parent| &manipulator.joints[parent].name)),
        };
        table.row([
            format!("{} {}{on}", i + 1, joint.name),
            if revolute { "revolute" } else { "prismatic" }.into(),
            a,
            alpha,
            d,
            theta,
            origin,
            axis,
        ]);
    }
    let ends = [("base", &description.base), ("tool", &description.tool)];
    let ends = ends.into_iter().filter_map(|(name, end)| Some(format!("  {name}: {}\n", pose(source, end.as_ref()?))));
    table.text() + &ends.collect::<String>()
}

/// a, alpha, d and theta as written, with the value where that is not a number; the joint variable is added to theta or to d.
fn dh_row(source: &Source, row: &JointDescription, i: usize, manipulator: &Manipulator, modified: bool) -> [String; 4] {
    let joint = &manipulator.joints[i];
    let written = [&row.a, &row.alpha, &row.d, &row.theta];
    let mut texts = written.map(|value| value.as_ref().map_or(String::new(), |v| in_one_line(&v.text(source))));
    let moved = &mut texts[if joint.kind == JointKind::Revolute { 3 } else { 2 }];
    *moved = match moved.strip_prefix('-') {
        _ if moved == "0" => format!("q{}", i + 1),
        Some(rest) if !rest.contains(['+', '-']) => format!("q{} - {}", i + 1, rest.trim_start()),
        Some(_) => format!("q{} + ({moved})", i + 1),
        None => format!("q{} + {moved}", i + 1),
    };
    if let Some(values) = denavit_hartenberg(manipulator, &joint.row, modified) {
        for ((text, value), written) in texts.iter_mut().zip(values).zip(written) {
            if written.as_ref().is_some_and(|expression| !expression.names().is_empty()) {
                *text += &format!(" ({})", digits(value));
            }
        }
    }
    texts
}

/// A text of the file in one line, without comments.
fn in_one_line(text: &str) -> String {
    let words = |line: &'_ str| -> Vec<String> {
        line.split_whitespace().take_while(|word| !word.starts_with('#')).map(str::to_owned).collect()
    };
    text.lines().flat_map(words).collect::<Vec<_>>().join(" ")
}

/// The origin and the axis, as written.
fn urdf_row(source: &Source, row: &JointDescription) -> [String; 2] {
    let axis = row.axis.as_ref().map_or(String::new(), |axis| in_one_line(source.slice(axis.span)));
    [row.origin.as_ref().map_or(String::new(), |origin| pose(source, origin)), axis]
}

/// A pose as written: translations by their numbers alone, rotations after their key.
fn pose(source: &Source, pose: &PoseDescription) -> String {
    let slice = |span| in_one_line(source.slice(span));
    let elements = pose.elements.iter().map(|element| {
        let rotation = element.rotation.as_ref().map(|rotation| match rotation {
            RotationDescription::Rpy(angles) => format!("rpy {}", in_one_line(&list_text(angles, source))),
            RotationDescription::Quat(quaternion) => format!("quat {}", slice(quaternion.span)),
            RotationDescription::AxisAngle(axis, angle) => {
                format!("axis {} angle {}", slice(axis.span), in_one_line(&angle.text(source)))
            }
            RotationDescription::XyAxes(axes) => format!("xyaxes {}", slice(axes.span)),
        });
        let translation = element.xyz.as_ref().map(|xyz| in_one_line(&list_text(xyz, source)));
        translation.into_iter().chain(rotation).collect::<Vec<_>>().join(" ")
    });
    elements.filter(|text| !text.is_empty()).collect::<Vec<_>>().join(", ")
}

/// The variables of coupled joints as sums over coordinates, a sentence each.
pub(super) fn couplings(manipulator: &Manipulator) -> Vec<String> {
    let Some(coupling) = &manipulator.coupling else { return Vec::new() };
    let coordinate = |a: usize| &manipulator.joints[coupling.coordinates[a]].name;
    let sentence = |(i, variable): (usize, &JointVariable)| {
        let own = &manipulator.joints[i].name;
        if coupling.is_plain(i) {
            return None;
        }
        let mut terms: Vec<String> = variable.factors.iter().map(|(a, factor)| term(factor, coordinate(*a))).collect();
        if !variable.offset.is_zero() || terms.is_empty() {
            terms.push(decimal(&variable.offset));
        }
        // The name of a joint with a coordinate is that of the coordinate.
        let of = if coupling.coordinates.contains(&i) { "variable of " } else { "" };
        Some(format!("{of}{own} = {}", sum(&terms)))
    };
    coupling.variables.iter().enumerate().filter_map(sentence).collect()
}

/// The points that two links share, a sentence each: a valid description has no others.
pub(super) fn closures(description: &RobotDescription) -> Vec<String> {
    let word = |given: &Option<Spanned<String>>| given.as_ref().map_or("", |given| given.value.as_str()).to_owned();
    let sentence = |closure: &ClosureDescription| {
        let name = closure.name.as_ref().map_or(String::new(), |name| format!("{}: ", name.value));
        format!("{name}the points of {} and {} are one in every posture", word(&closure.joint), word(&closure.with))
    };
    description.closes.iter().map(sentence).collect()
}

/// A factor times a variable.
fn term(factor: &Number, name: &str) -> String {
    match (factor.is_one(), (-factor).is_one()) {
        (true, _) => name.to_owned(),
        (_, true) => format!("-{name}"),
        _ => format!("{} {name}", decimal(factor)),
    }
}

fn sum(terms: &[String]) -> String {
    terms.join(" + ").replace("+ -", "- ")
}

/// The motors that ride elsewhere than on the link before their joint, turn with several joints, or drive a coupled joint, a sentence each. Where
/// joints are coupled, their rates are those of coordinates.
pub(super) fn motors(manipulator: &Manipulator) -> Vec<String> {
    let name = |joint: usize| manipulator.joints[joint].name.as_str();
    let in_coordinates = manipulator.motor_rates();
    let coordinates = manipulator.coordinates();
    let sentence = |(i, joint): (usize, &Joint)| {
        let coupled = manipulator.coupling.as_ref().is_some_and(|coupling| !coupling.is_plain(i));
        let motor = joint.motor.as_ref().filter(|_| coupled || joint.plain_motor().is_none())?;
        let on = motor.carrier.map_or("the base".to_owned(), |link| format!("link {}", name(link.index())));
        let rates = in_coordinates.iter().find(|(of, _)| manipulator.coupling.is_some() && of.name == joint.name);
        let terms: Vec<String> = match rates {
            Some((_, rates)) => {
                let of = rates.iter().zip(&coordinates).filter(|(rate, _)| !rate.is_zero());
                of.map(|(rate, coordinate)| term(rate, &coordinate.joint.name)).collect()
            }
            None => {
                let own = term(&nominal(manipulator, &motor.ratio), &joint.name);
                [own].into_iter().chain(motor.coupling.iter().map(|(other, factor)| term(factor, name(*other)))).collect()
            }
        };
        let turns = if terms.is_empty() { "0".to_owned() } else { sum(&terms) };
        Some(format!("that of {} rides on {on} and turns by {turns} beside it", joint.name))
    };
    manipulator.joints.iter().enumerate().filter_map(sentence).collect()
}

/// The limits of the joints, angles also in degrees, and where joints are coupled those of coordinates; `None` without limits.
pub(super) fn limits(manipulator: &Manipulator) -> Option<String> {
    let joints = manipulator.joints.iter().enumerate();
    let of_joints =
        limits_of("limits", joints.map(|(i, joint)| (format!("{} {}", i + 1, joint.name), joint.kind, &joint.limits)));
    let coordinates = manipulator.coordinates().into_iter().filter(|_| manipulator.coupling.is_some());
    let of_coordinates = limits_of(
        "limits of coordinates",
        coordinates.map(|Coordinate { joint, limits, .. }| (joint.name.clone(), joint.kind, limits)),
    );
    let tables: Vec<String> = of_joints.into_iter().chain(of_coordinates).collect();
    (!tables.is_empty()).then(|| tables.join("\n"))
}

fn limits_of<'a>(title: &'static str, rows: impl Iterator<Item = (String, JointKind, &'a Limits)>) -> Option<String> {
    let mut table =
        Table::new([(title, Left), ("position", Left), ("", Left), ("velocity", Right), ("", Left), ("effort", Right)]);
    for (name, kind, limits) in rows {
        let revolute = kind == JointKind::Revolute;
        let [angle, torque] = if revolute { ["rad", "N m"] } else { ["m", "N"] };
        let degrees = |value: &Number| digits(value.to_f64().to_degrees());
        let position = limits.position.as_ref();
        let velocity = limits.velocity.as_ref();
        table.row([
            name,
            position.map_or(String::new(), |[low, high]| format!("{} to {} {angle}", decimal(low), decimal(high))),
            position
                .filter(|_| revolute)
                .map_or(String::new(), |[low, high]| format!("{} to {} deg", degrees(low), degrees(high))),
            velocity.map_or(String::new(), |value| format!("{} {angle}/s", decimal(value))),
            velocity.filter(|_| revolute).map_or(String::new(), |value| format!("{} deg/s", degrees(value))),
            limits.effort.as_ref().map_or(String::new(), |value| format!("{} {torque}", decimal(value))),
        ]);
    }
    table.says_more_than_names().then(|| table.text())
}

/// Drives and friction of the joints; `None` if the file gives no such value.
pub(super) fn drives(manipulator: &Manipulator) -> Option<String> {
    let mut table = Table::new([
        ("drive", Left),
        ("ratio", Right),
        ("rotor", Right),
        ("at the joint", Right),
        ("rotor's mass", Right),
        ("viscous", Right),
        ("Coulomb", Right),
        ("offset", Right),
        ("cubic", Right),
        ("load", Right),
        ("Stribeck", Left),
        ("spring", Left),
    ]);
    for (i, joint) in manipulator.joints.iter().enumerate() {
        table.row(drive(i, joint, manipulator));
    }
    table.says_more_than_names().then(|| table.text())
}

fn drive(i: usize, joint: &Joint, manipulator: &Manipulator) -> [String; 12] {
    let revolute = joint.kind == JointKind::Revolute;
    let [inertia, torque, damping, cubed, rate, angle] = match revolute {
        true => ["kg m²", "N m", "N m s", "N m s³", "rad/s", "rad"],
        false => ["kg", "N", "N s/m", "N s³/m³", "m/s", "m"],
    };
    let number = |value: &Polynomial| nominal(manipulator, value);
    let cell = |value: Option<&Polynomial>, unit: &str| match value.map(number).filter(|value| !value.is_zero()) {
        Some(value) => format!("{} {unit}", decimal(&value)),
        None => String::new(),
    };
    let motor = joint.motor.as_ref();
    let rotor = motor.and_then(|motor| motor.inertia.as_ref());
    // The inertia of rotor and armature at the joint: ratio² I + armature.
    let square = motor.map(|motor| &motor.ratio * &motor.ratio);
    let reflected = rotor.zip(square.as_ref()).map(|(inertia, square)| square * inertia);
    let felt = [&reflected, &joint.armature].into_iter().flatten().cloned().reduce(|a, b| &a + &b);
    let at_rotor = motor.and_then(|motor| motor.viscous.as_ref()).zip(square.as_ref()).map(|(viscous, square)| square * viscous);
    let viscous = [&at_rotor, &joint.viscous].into_iter().flatten().cloned().reduce(|a, b| &a + &b);
    [
        format!("{} {}", i + 1, joint.name),
        motor.map_or(String::new(), |motor| decimal(&number(&motor.ratio))),
        cell(rotor, "kg m²"),
        cell(felt.as_ref(), inertia),
        cell(motor.map(|motor| &motor.mass), "kg"),
        cell(viscous.as_ref(), damping),
        match (cell(joint.coulomb.as_ref(), torque), &joint.smooth) {
            (coulomb, Some(v)) => format!("{coulomb}, smooth within {} {rate}", decimal(v)),
            (coulomb, None) => coulomb,
        },
        cell(joint.offset.as_ref(), torque),
        cell(joint.cubic.as_ref(), cubed),
        joint.load.as_ref().filter(|load| !load.is_zero()).map_or(String::new(), |load| format!("{} |g|", decimal(load))),
        joint
            .stribeck
            .as_ref()
            .map_or(String::new(), |s| format!("{} {torque} at {} {rate}", decimal(&number(&s.torque)), decimal(&s.velocity))),
        joint.spring.as_ref().map_or(String::new(), |s| {
            format!("{} {torque}/{angle} about {} {angle}", decimal(&number(&s.stiffness)), decimal(&number(&s.rest)))
        }),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A name's value follows it, also in the `base` before the first row.
    #[test]
    fn values_are_those_of_the_row() {
        for convention in ["standard", "modified"] {
            let text = format!(
                "name: a\nconvention: {convention}\ngravity: [0, 0, -9.81]\nbase: {{xyz: [0.5, 0, 1], rpy: [0.1, 0, pi/2]}}\n\
                 parameters: {{l: 0.2, w: 0.7, h: 0.3, t: 0.1}}\njoints:\n  \
                 - {{name: j, type: revolute, a: l, alpha: w, d: -h, theta: t, link: {{mass: 1, inertia: {{xx: 1, yy: 1, zz: 1}}}}}}\n"
            );
            let source = Source::new("a.yaml", text);
            let (manipulator, _) = armgen_codegen::validate::read(&source).0.expect("it is valid");
            let description = RobotDescription::parse(&source).0.expect("it can be read");
            let text = rows(&source, &description, &manipulator);
            let row = text.lines().nth(1).expect("a row").split("  ").filter(|cell| !cell.is_empty()).map(str::trim);
            assert_eq!(row.skip(2).collect::<Vec<_>>(), ["l (0.2)", "w (0.7)", "-h (-0.3)", "q1 + t (0.1)"], "{convention}");
        }
    }
}
