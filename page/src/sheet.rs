//! The data sheet of a page: the rows with source texts, numbers and warnings.

use std::fmt::Write;

use armgen_codegen::description::Convention;

use crate::html::{decimal, escape};
use crate::rows::Row;
use crate::warnings::Warnings;

pub(crate) fn table(rows: &[Row], convention: Convention, warnings: &Warnings<'_>) -> String {
    let urdf = convention == Convention::Urdf;
    let columns: &[&str] =
        if urdf { &["origin [<span data-unit=\"m\">m</span>]", "axis"] } else { &["a", "alpha", "d", "theta"] };
    let mut text = String::from("<div class=\"scroll\" tabindex=\"0\" role=\"region\" aria-label=\"Rows of the data sheet\">\n<table id=\"sheet\">\n<caption>");
    text += match convention {
        Convention::Standard => "Standard Denavit-Hartenberg rows: Rz(theta) Tz(d) Tx(a) Rx(alpha)",
        Convention::Modified => "Modified Denavit-Hartenberg rows: Rx(alpha) Tx(a) Rz(theta) Tz(d)",
        Convention::Urdf => "Rows of a URDF: origin, then the motion about or along the axis",
    };
    let _ = writeln!(
        text,
        ".<span class=\"keys\"> A row in focus or under the pointer is drawn on the arm.</span> Lines are those of {}.</caption>",
        escape(warnings.file())
    );
    text += "<thead><tr><th scope=\"col\">joint</th><th scope=\"col\">type</th>";
    for column in columns {
        let _ = write!(text, "<th scope=\"col\">{column}</th>");
    }
    text += "<th scope=\"col\">limits</th><th scope=\"col\">line</th></tr></thead>\n<tbody>\n";
    for (i, row) in rows.iter().enumerate() {
        let number = i + 1;
        // A joint hangs on the one above, but for those that begin a branch.
        let on = match &row.branch {
            Some((parent, _)) if *parent != i.checked_sub(1) => {
                format!(", on {}", parent.map_or("the base".to_owned(), |parent| escape(&rows[parent].name)))
            }
            _ => String::new(),
        };
        let _ = write!(
            text,
            "<tr data-row=\"{number}\" tabindex=\"0\"><th scope=\"row\">{number} {}{on}</th><td>{}</td>",
            escape(&row.name),
            if row.revolute { "revolute" } else { "prismatic" },
        );
        text += &values(row, number);
        text += &limits(row);
        let _ = writeln!(text, "<td>{}</td></tr>", row.line);
        let said = warnings.of_row(i);
        if !said.is_empty() {
            let columns = columns.len() + 4;
            let _ = writeln!(text, "<tr data-row=\"{number}\" class=\"said\"><td colspan=\"{columns}\">{said}</td></tr>");
        }
    }
    text += "</tbody>\n</table>\n</div>\n";
    text + &warnings.others()
}

fn values(row: &Row, number: usize) -> String {
    let mut text = String::new();
    if let Some(values) = &row.denavit_hartenberg {
        for (k, value) in values.iter().enumerate() {
            let unit = ["m", "rad", "m", "rad"][k];
            let moved = k == if row.revolute { 3 } else { 2 };
            let variable = format!("<i>q</i><sub>{number}</sub>");
            let written = match (moved, value.written.as_str()) {
                (false, written) => escape(written),
                (true, "0") => variable,
                (true, written) => format!("{} + {variable}", escape(written)),
            };
            let offset = if moved { "offset " } else { "" };
            let _ = write!(
                text,
                "<td><span class=\"written\">{written}</span> <span class=\"small\">{offset}<span class=\"number\" data-value=\"{:?}\" data-unit=\"{unit}\">{} {unit}</span></span></td>",
                value.number,
                decimal(value.number),
            );
        }
    }
    if let Some([origin, axis]) = &row.urdf {
        let _ = write!(text, "<td class=\"written\">{}</td><td class=\"written\">{}</td>", escape(origin), escape(axis));
    }
    text
}

fn limits(row: &Row) -> String {
    let unit = if row.revolute { "rad" } else { "m" };
    match row.limits {
        None => "<td>none</td>".into(),
        Some([low, high]) => format!(
            "<td><span class=\"written\">{}</span> <span class=\"number\" data-value=\"{low:?}\" data-unit=\"{unit}\">{} {unit}</span> to <span class=\"number\" data-value=\"{high:?}\" data-unit=\"{unit}\">{} {unit}</span></td>",
            escape(&row.limits_written),
            decimal(low),
            decimal(high)
        ),
    }
}
