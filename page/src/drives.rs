//! The data of each joint's drive: motor, friction, spring and limits; and the named parameters of the description.

use std::fmt::Write;

use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::description::{list_text, JointDescription, RobotDescription};
use armgen_codegen::document::Expression;
use armgen_codegen::exact::{Number, Polynomial};
use armgen_codegen::kinds::JointKind;
use armgen_codegen::manipulator::{Joint, Manipulator};
use armgen_codegen::source::{Source, Spanned};

use crate::html::{decimal, escape, sentence};

/// A value of a joint: its source text and its number.
struct Cell {
    written: String,
    number: Option<f64>,
}

/// A column: its quantity, and its units for revolute and prismatic joints.
struct Column {
    title: &'static str,
    units: [&'static str; 2],
    cells: Vec<Option<Cell>>,
}

/// The tables that have any entries.
pub(crate) fn tables(source: &Source, description: &RobotDescription, manipulator: &Manipulator) -> String {
    let written = description.joints.iter().flat_map(|joints| &joints.value);
    let joints: Vec<(&Joint, &JointDescription)> = manipulator.joints.iter().zip(written).collect();
    drives(&joints, columns(source, manipulator, &joints)) + &parameters(source, description, manipulator)
}

fn columns(source: &Source, manipulator: &Manipulator, joints: &[(&Joint, &JointDescription)]) -> Vec<Column> {
    type Written<'a> = Option<&'a Expression>;
    let exact = |of: Option<&Number>| of.map(Number::to_f64);
    let of = |of: Option<&Polynomial>| of.map(|of| nominal(manipulator, of).to_f64());
    let cell = |written: Written, number: Option<f64>| {
        let written = written?.text(source);
        Some(Cell { written, number })
    };
    let text = |lists: [Option<String>; 2]| {
        let words: Vec<String> = lists.into_iter().flatten().collect();
        (!words.is_empty()).then(|| Cell { written: words.join(", axis "), number: None })
    };
    let column = |title, units, cell: &dyn Fn(&Joint, &JointDescription) -> Option<Cell>| Column {
        title,
        units,
        cells: joints.iter().map(|(joint, row)| cell(joint, row)).collect(),
    };
    let motor = |title,
                 units,
                 own: &dyn Fn(&armgen_codegen::manipulator::Motor) -> Option<f64>,
                 pick: fn(&JointDescription) -> Written| {
        column(title, units, &|joint, row| cell(pick(row), joint.motor.as_ref().and_then(own)))
    };
    let all = vec![
        motor("ratio of the motor", ["", "rad/m"], &|m| of(Some(&m.ratio)), |row| row.motor.as_ref()?.ratio.as_ref()),
        motor("inertia of the rotor", ["kg m²"; 2], &|m| of(m.inertia.as_ref()), |row| row.motor.as_ref()?.inertia.as_ref()),
        motor("mass of the rotor", ["kg"; 2], &|m| of(Some(&m.mass)), |row| row.motor.as_ref()?.mass.as_ref()),
        column("place of the rotor", [""; 2], &|_, row| {
            let motor = row.motor.as_ref()?;
            let mut place = text([&motor.position, &motor.axis].map(|list| list.as_ref().map(|list| list_text(list, source))))?;
            if let Some(on) = &motor.on {
                place.written = format!("on {}: {}", on.value, place.written);
            }
            Some(place)
        }),
        column("coupling of the motor", [""; 2], &|_, row| {
            let leaders = &row.motor.as_ref()?.coupling.as_ref()?.leaders;
            let each = |(name, factor): &(Spanned<String>, Option<Expression>)| {
                format!("{}: {}", name.value, factor.as_ref().map_or(String::new(), |f| f.text(source)))
            };
            Some(Cell { written: leaders.iter().map(each).collect::<Vec<_>>().join(", "), number: None })
        }),
        motor("viscous at the rotor", ["N m s"; 2], &|m| of(m.viscous.as_ref()), |row| row.motor.as_ref()?.viscous.as_ref()),
        column("viscous friction", ["N m s", "N s/m"], &|j, row| cell(row.friction.viscous.as_ref(), of(j.viscous.as_ref()))),
        column("Coulomb friction", ["N m", "N"], &|j, row| cell(row.friction.coulomb.as_ref(), of(j.coulomb.as_ref()))),
        column("its smooth rate", ["rad/s", "m/s"], &|j, row| cell(row.friction.smooth.as_ref(), exact(j.smooth.as_ref()))),
        column("its offset", ["N m", "N"], &|j, row| cell(row.friction.offset.as_ref(), of(j.offset.as_ref()))),
        column("cubic friction", ["N m s³", "N s³/m³"], &|j, row| cell(row.friction.cubic.as_ref(), of(j.cubic.as_ref()))),
        column("friction of the load", [""; 2], &|j, row| cell(row.friction.load.as_ref(), exact(j.load.as_ref()))),
        column("Stribeck torque", ["N m", "N"], &|j, row| {
            let written = row.friction.stribeck.as_ref()?.torque.as_ref();
            cell(written, of(j.stribeck.as_ref().map(|stribeck| &stribeck.torque)))
        }),
        column("Stribeck rate", ["rad/s", "m/s"], &|j, row| {
            let written = row.friction.stribeck.as_ref()?.velocity.as_ref();
            cell(written, exact(j.stribeck.as_ref().map(|stribeck| &stribeck.velocity)))
        }),
        column("armature", ["kg m²", "kg"], &|j, row| cell(row.armature.as_ref(), of(j.armature.as_ref()))),
        column("stiffness of the spring", ["N m/rad", "N/m"], &|j, row| {
            cell(row.spring.as_ref()?.stiffness.as_ref(), of(j.spring.as_ref().map(|spring| &spring.stiffness)))
        }),
        column("rest of the spring", ["rad", "m"], &|j, row| {
            cell(row.spring.as_ref()?.rest.as_ref(), of(j.spring.as_ref().map(|spring| &spring.rest)))
        }),
        column("highest rate", ["rad/s", "m/s"], &|j, row| cell(row.limits.velocity.as_ref(), exact(j.limits.velocity.as_ref()))),
        column("highest effort", ["N m", "N"], &|j, row| cell(row.limits.effort.as_ref(), exact(j.limits.effort.as_ref()))),
    ];
    all.into_iter().filter(|column| column.cells.iter().any(Option::is_some)).collect()
}

/// A title from the columns that exist.
fn title(columns: &[Column]) -> String {
    let kind = |title: &str| match title {
        "viscous at the rotor" => "friction",
        "highest rate" | "highest effort" => "limits of rates and efforts",
        title if title.ends_with("of the spring") => "springs",
        title if title.ends_with("rotor") || title.ends_with("motor") || title == "armature" => "motors",
        _ => "friction",
    };
    let mut kinds: Vec<&str> = Vec::new();
    for column in columns {
        if !kinds.contains(&kind(column.title)) {
            kinds.push(kind(column.title));
        }
    }
    let (last, others) = kinds.split_last().map_or(("", &[][..]), |(last, others)| (*last, others));
    let text = if others.is_empty() { last.to_owned() } else { format!("{} and {last}", others.join(", ")) };
    sentence(&text)
}

/// Motors, friction, springs and the limits of rates and efforts, a joint per row; empty if no joint has any.
fn drives(joints: &[(&Joint, &JointDescription)], columns: Vec<Column>) -> String {
    if columns.is_empty() {
        return String::new();
    }
    let heads: String = columns.iter().map(|column| format!("<th scope=\"col\">{}</th>", column.title)).collect();
    let mut text = start(&title(&columns), "drives", &format!("<th scope=\"col\">joint</th>{heads}"));
    for (i, (joint, _)) in joints.iter().enumerate() {
        let _ = write!(text, "<tr><th scope=\"row\">{} {}</th>", i + 1, escape(&joint.name));
        let kind = usize::from(joint.kind == JointKind::Prismatic);
        for column in &columns {
            let cell = column.cells[i].as_ref();
            let _ = write!(text, "<td>{}</td>", cell.map_or("–".into(), |cell| value(cell, column.units[kind])));
        }
        text += "</tr>\n";
    }
    text + "</tbody></table></div></details>\n"
}

/// The named parameters; empty without parameters.
fn parameters(source: &Source, description: &RobotDescription, manipulator: &Manipulator) -> String {
    if description.parameters.is_empty() {
        return String::new();
    }
    let head = "<th scope=\"col\">parameter</th><th scope=\"col\">value</th>";
    let mut text = start("Parameters", "parameters", head);
    for parameter in &description.parameters {
        let name = &parameter.name.value;
        let symbol = manipulator.parameters.iter().find(|symbol| symbol.name == *name);
        let written = parameter.value.as_ref().map_or(String::new(), |value| source.slice(value.span).to_string());
        let cell = Cell { written, number: symbol.map(|symbol| symbol.nominal.to_f64()) };
        let _ = writeln!(text, "<tr><th scope=\"row\">{}</th><td>{}</td></tr>", escape(name), value(&cell, ""));
    }
    text + "</tbody></table></div></details>\n"
}

/// The beginning of a table that the reader can fold.
fn start(title: &str, id: &str, heads: &str) -> String {
    format!(
        "<details><summary>{title}</summary><div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"{title}\">\
         <table id=\"{id}\"><thead><tr>{heads}</tr></thead><tbody>\n"
    )
}

/// The source text, and below it the number if it adds information.
fn value(cell: &Cell, unit: &str) -> String {
    let Cell { written, number } = cell;
    let said = number.map(|number| format!("{} {unit}", decimal(number)).trim().to_owned()).filter(|said| said != written);
    let below = said.map_or(String::new(), |said| format!(" <span class=\"number\">{}</span>", escape(&said)));
    format!("<span class=\"written\">{}</span>{below}", escape(written))
}
