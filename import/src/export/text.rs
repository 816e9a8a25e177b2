//! The text of a URDF.

use std::fmt::Write;

use super::{Body, Motion, Pose, Urdf};

/// The text of a URDF.
pub(super) fn print(urdf: &Urdf) -> String {
    let mut text = String::from("<?xml version=\"1.0\"?>\n");
    let mut line = |words: String| writeln!(text, "{words}").expect("a text takes it");
    let newer = urdf.parts.iter().filter_map(|part| part.motion.as_ref()).any(Motion::needs_version_1_2);
    let version = if newer { " version=\"1.2\"" } else { "" };
    line(format!("<robot name=\"{}\"{version}>", escaped(&urdf.name)));
    line("  <link name=\"base\"/>".to_owned());
    for part in &urdf.parts {
        let kind = part.motion.as_ref().map_or("fixed", |motion| motion.kind);
        line(format!("  <joint name=\"{}\" type=\"{kind}\">", escaped(&part.joint)));
        if !part.origin.is_identity() {
            line(format!("    {}", origin(&part.origin)));
        }
        line(format!("    <parent link=\"{}\"/>", escaped(&part.parent)));
        line(format!("    <child link=\"{}\"/>", escaped(&part.link)));
        if let Some(motion) = &part.motion {
            motion_lines(motion).into_iter().for_each(|words| line(format!("    {words}")));
        }
        line("  </joint>".to_owned());
        match &part.body {
            None => line(format!("  <link name=\"{}\"/>", escaped(&part.link))),
            Some(body) => {
                line(format!("  <link name=\"{}\">", escaped(&part.link)));
                line("    <inertial>".to_owned());
                body_lines(body).into_iter().for_each(|words| line(format!("      {words}")));
                line("    </inertial>".to_owned());
                line("  </link>".to_owned());
            }
        }
    }
    line("</robot>".to_owned());
    text
}

fn origin(pose: &Pose) -> String {
    let given = |numbers: &[String; 3]| numbers.iter().any(|x| x != "0");
    let mut text = String::from("<origin");
    for (name, numbers) in [("xyz", &pose.xyz), ("rpy", &pose.rpy)] {
        if given(numbers) {
            text += &format!(" {name}=\"{}\"", numbers.join(" "));
        }
    }
    text + "/>"
}

impl Motion {
    /// Whether it has limits that a URDF has since version 1.2.
    fn needs_version_1_2(&self) -> bool {
        self.acceleration.is_some() || self.jerk.is_some()
    }
}

fn motion_lines(motion: &Motion) -> Vec<String> {
    let mut lines = vec![format!("<axis xyz=\"{}\"/>", motion.axis.join(" "))];
    let zero = || "0".to_owned();
    let (velocity, effort) = (motion.velocity.clone(), motion.effort.clone());
    if motion.kind != "continuous" || velocity.is_some() || effort.is_some() || motion.needs_version_1_2() {
        let position = match &motion.position {
            Some([low, high]) => format!("lower=\"{low}\" upper=\"{high}\" "),
            None => String::new(),
        };
        let (velocity, effort) = (velocity.unwrap_or_else(zero), effort.unwrap_or_else(zero));
        // A description has one limit for both.
        let newer = [("acceleration", &motion.acceleration), ("deceleration", &motion.acceleration), ("jerk", &motion.jerk)];
        let newer: String = newer.iter().filter_map(|(name, value)| Some(format!(" {name}=\"{}\"", value.as_ref()?))).collect();
        lines.push(format!("<limit {position}effort=\"{effort}\" velocity=\"{velocity}\"{newer}/>"));
    }
    if let Some([leader, factor, offset]) = &motion.mimic {
        lines.push(format!("<mimic joint=\"{}\" multiplier=\"{factor}\" offset=\"{offset}\"/>", escaped(leader)));
    }
    let friction = [("damping", &motion.viscous), ("friction", &motion.coulomb)];
    let given: Vec<String> =
        friction.iter().filter_map(|(name, value)| Some(format!("{name}=\"{}\"", value.as_ref()?))).collect();
    if !given.is_empty() {
        lines.push(format!("<dynamics {}/>", given.join(" ")));
    }
    lines
}

fn body_lines(body: &Body) -> Vec<String> {
    let mut lines = Vec::new();
    if !body.origin.is_identity() {
        lines.push(origin(&body.origin));
    }
    lines.push(format!("<mass value=\"{}\"/>", body.mass));
    let [xx, xy, yy, xz, yz, zz] = &body.inertia;
    lines.push(format!("<inertia ixx=\"{xx}\" ixy=\"{xy}\" ixz=\"{xz}\" iyy=\"{yy}\" iyz=\"{yz}\" izz=\"{zz}\"/>"));
    lines
}

/// A text within an attribute.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
