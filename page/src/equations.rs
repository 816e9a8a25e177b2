//! The equations of a page: the output of `armgen show`, compressed.
//!
//! The texts of an arm of seven joints take 1 MB with their LaTeX, and a quarter of that compressed.
//! Neighbouring quantities repeat large parts of each other, so several share a packet; separately, those of a small arm need almost
//! twice the space. The script decompresses a packet when the reader opens a section of one of its quantities.

use std::fmt::Write;

use armgen_codegen::catalogue::Absent;
use armgen_codegen::manipulator::{LinkId, Pose};
use armgen_codegen::parallel::parallel_map;
use armgen_codegen::show::{Form, Item, Reading, Sheet, Shown, Style, ASK_THE_PAGE};
use armgen_codegen::Model;
use serde_json::{json, Map, Value};

use crate::html::{escape, pack, with_code};
use crate::words;

/// The page omits a quantity with a longer text, and shows the command that prints it.
const LONGEST: usize = 400_000;

/// Limit on all texts of a page in bytes, before compression; beyond it, the page omits the longest texts.
const TOGETHER: usize = 2_800_000;

/// Size limit of a packet with several texts: a reader who opens a section waits for its whole packet.
const PACKET: usize = 131_072;

/// All quantities: those in the page, and those that it only names.
pub(crate) struct Equations {
    quantities: Vec<Quantity>,
    absent: Vec<Absent>,
    pub(crate) determinant: Determinant,
}

/// Where the Jacobian is singular, for the script.
pub(crate) struct Determinant {
    /// The factors of the determinant, or the common factors of all minors, with the description's numbers; and their zeros.
    pub(crate) factors: Value,
    /// The same for the first six joints of an arm with more joints than the six rows of its task; otherwise null.
    pub(crate) first_six: Value,
}

impl Determinant {
    /// Without the common factors of all minors, whose search takes a sixth of the time of a picture; few arms have any.
    pub(crate) fn without_common_factors(model: &Model) -> Determinant {
        let is_redundant = model.manipulator.dof() > model.manipulator.task.len();
        let items: &[Item] = if is_redundant { &[] } else { &[Item::Determinant] };
        Determinant::of(model, &Sheet::in_style(model, items, Reading::Nominal, CLOSED))
    }

    /// Of a sheet with the determinant.
    fn of(model: &Model, sheet: &Sheet) -> Determinant {
        let factors = sheet.quantities.iter().find(|shown| shown.factors.is_some());
        Determinant {
            factors: factors.map_or(Value::Null, factors_of),
            first_six: first_six(model).as_ref().map_or(Value::Null, factors_of),
        }
    }
}

/// Prefer closed forms, because a page can fold them.
const CLOSED: Style = Style { form: Form::Closed, digits: None };

struct Quantity {
    name: String,
    symbol: String,
    size: String,
    /// The input of the script, as JSON; `None` if it is too long.
    text: Option<String>,
    steps: usize,
}

impl Equations {
    pub(crate) fn new(model: &Model) -> Equations {
        let [nominal, symbolic] = Sheet::in_both_readings(model, &Item::all(&model.manipulator.tips), CLOSED);
        let mut quantities = parallel_map(&nominal.quantities, |shown| {
            let other = symbolic.quantities.iter().find(|other| other.name == shown.name);
            quantity(&nominal.robot, shown, other)
        });
        leave_out(&mut quantities);
        Equations { quantities, determinant: Determinant::of(model, &nominal), absent: nominal.absent }
    }

    /// The input of the script: the packets, and the packet's index for the name of each quantity.
    pub(crate) fn data(&self) -> Value {
        let mut packets: Vec<String> = Vec::new();
        let mut of = Map::new();
        for quantity in &self.quantities {
            let Some(text) = &quantity.text else { continue };
            match packets.last_mut() {
                Some(last) if last.len() + text.len() < PACKET => last.push(','),
                _ => packets.push("{".into()),
            }
            of.insert(quantity.name.clone(), json!(packets.len() - 1));
            let _ = write!(packets.last_mut().expect("one was begun"), "{}:{text}", json!(quantity.name));
        }
        let packed = parallel_map(&packets, |packet| pack(&format!("{packet}}}")));
        json!({"of": of, "packets": packed})
    }

    /// The section; the script fills its parts when the reader opens them.
    pub(crate) fn section(&self) -> String {
        let mut text = String::from(CHOICES);
        for quantity in &self.quantities {
            let (name, symbol, size) = (escape(&quantity.name), typeset(&quantity.symbol), &quantity.size);
            let words = in_words(&name);
            let about = words::about(&quantity.name).map_or(String::new(), |text| format!(" title=\"{}\"", escape(text)));
            let _ = match &quantity.text {
                Some(_) => writeln!(
                    text,
                    "<details data-equation=\"{name}\"><summary{about}><b>{symbol}</b> {words}, {size}</summary><div></div></details>"
                ),
                None => writeln!(
                    text,
                    "<p class=\"small\"><b>{symbol}</b> {words}, {size}: left out, {} steps. <code>armgen show ROBOT.yaml {name}</code> prints it.</p>",
                    quantity.steps
                ),
            };
        }
        for Absent { function, reason } in &self.absent {
            // The reader whom `show` sends to the page is already there.
            let reason = with_code(reason).replace(&with_code(ASK_THE_PAGE), ASKED);
            let _ = writeln!(text, "<p class=\"small\">{}: {reason}.</p>", escape(&function.replace('_', " ")));
        }
        text
    }
}

/// The factors of a determinant, or the common factors of all minors, and their zeros.
fn factors_of(shown: &Shown) -> Value {
    let value = serde_json::to_value(shown).expect("strings and numbers always have a JSON form");
    json!({"factors": value["factors"], "common": value["common_factors"], "singular": value["singular"]})
}

/// The determinant of the first six columns of the Jacobian of a longer arm, which equals that of the arm without the other joints:
/// if all six rows matter, the choice of frame does not change it. J can lose rank only where it is zero.
fn first_six(model: &Model) -> Option<Shown> {
    let whole = &model.manipulator;
    let sixth = LinkId(5);
    if whole.task.len() != 6 || whole.branches() || whole.coupling.is_some() || whole.joints.get(6)?.parent != Some(sixth) {
        return None;
    }
    let mut shorter = whole.clone();
    shorter.tip = sixth;
    shorter.joints.truncate(6);
    shorter.tool = Pose::identity();
    let mut sheet = Sheet::in_style(&Model::new(shorter), &[Item::Determinant], Reading::Nominal, CLOSED);
    sheet.quantities.pop()
}

/// The place on a page that answers [`ASK_THE_PAGE`].
const ASKED: &str = "<a href=\"#singular\">w = √det(J Jᵀ) among the numbers</a> is 0 where J loses rank";

/// The name of a function for a heading.
fn in_words(name: &str) -> String {
    let words =
        name.replace('_', " ").replace("center", "centre").replace("coriolis", "Coriolis").replace("jacobian", "Jacobian");
    [(" by ddq", " by q̈"), (" by dq", " by q̇"), (" by tau", " by τ")]
        .iter()
        .fold(words, |text, (from, to)| text.replace(from, to))
}

const CHOICES: &str = "<div class=\"controls\"><fieldset><legend>Parameters</legend>\
<label><input type=\"radio\" name=\"form\" value=\"nominal\" checked> numbers</label> \
<label><input type=\"radio\" name=\"form\" value=\"symbolic\"> names</label></fieldset>\
<fieldset><legend>Constants</legend>\
<label><input type=\"radio\" name=\"digits\" value=\"decimal\" checked> six digits</label> \
<label><input type=\"radio\" name=\"digits\" value=\"exact\"> exact</label></fieldset></div>
<p id=\"names\" class=\"small\" hidden></p>
";

/// A symbol in typeset form: Greek letters, dots, indices, and ∂ for partial derivatives.
fn typeset(symbol: &str) -> String {
    const SIGNS: [(&str, &str); 6] =
        [("dtau/", "∂τ/"), ("d(ddq)/", "∂q̈/"), ("/d(dq)", "/∂q̇"), ("/dq", "/∂q"), ("^-1", "⁻¹"), ("'", "ᵀ")];
    const WORDS: [(&str, &str); 5] =
        [("tau", "τ"), ("dq", "q̇"), ("ddq", "q̈"), ("dqr", "q̇<sub>r</sub>"), ("ddqr", "q̈<sub>r</sub>")];
    let signs = SIGNS.iter().fold(symbol.to_owned(), |text, (from, to)| text.replace(from, to));
    let inside = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let mut text = String::new();
    let mut rest = signs.as_str();
    while !rest.is_empty() {
        let end = rest.find(|c| !inside(c)).unwrap_or(rest.len());
        let (word, after) = rest.split_at(end);
        let (head, index) = word.split_once('_').unwrap_or((word, ""));
        text += WORDS.iter().find(|(name, _)| *name == head).map_or(head, |(_, sign)| sign);
        if !index.is_empty() {
            let _ = write!(text, "<sub>{index}</sub>");
        }
        let next = after.find(inside).unwrap_or(after.len());
        text += &escape(&after[..next]);
        rest = &after[next..];
    }
    text
}

/// Drops the longest texts until the rest fits into [`TOGETHER`].
fn leave_out(quantities: &mut [Quantity]) {
    let length = |quantity: &Quantity| quantity.text.as_ref().map_or(0, String::len);
    let mut order: Vec<usize> = (0..quantities.len()).collect();
    order.sort_by_key(|&k| length(&quantities[k]));
    let mut together = 0;
    for k in order {
        together += length(&quantities[k]);
        if together > TOGETHER {
            quantities[k].text = None;
        }
    }
}

fn quantity(robot: &str, nominal: &Shown, symbolic: Option<&Shown>) -> Quantity {
    let value = |shown: &Shown| serde_json::to_value(shown).expect("strings and numbers always have a JSON form");
    let latex = |shown: &Shown| {
        let sheet = Sheet { robot: robot.to_owned(), quantities: vec![shown.clone()], absent: Vec::new() };
        sheet.latex()
    };
    let form = value(nominal);
    let steps = form["steps"].as_array().map_or(0, Vec::len);
    let length = form.to_string().len();
    let text = (length <= LONGEST).then(|| {
        let other = symbolic.map(|shown| (value(shown), shown)).filter(|(other, _)| *other != form);
        let texts: Vec<String> = std::iter::once(latex(nominal)).chain(other.iter().map(|(_, shown)| latex(shown))).collect();
        let whole = json!({
            "letter": nominal.letter[0],
            "columnNames": nominal.column_names,
            "nominal": form,
            "symbolic": other.map(|(value, _)| value),
            "latex": texts,
        });
        whole.to_string()
    });
    let size = match (nominal.rows, nominal.columns) {
        (1, 1) => "a number".to_owned(),
        (rows, 1) => format!("{rows} entries"),
        (rows, columns) => format!("{rows} × {columns}"),
    };
    Quantity { name: nominal.name.clone(), symbol: nominal.symbol[0].clone(), size, text, steps }
}

#[cfg(test)]
mod tests {
    use super::{in_words, typeset};

    #[test]
    fn symbols_are_typeset() {
        let check = |symbol: &str, expected: &str| assert_eq!(typeset(symbol), expected);
        check("T_e(q)", "T<sub>e</sub>(q)");
        check("tau_known(q, dq, dqr, ddqr)", "τ<sub>known</sub>(q, q̇, q̇<sub>r</sub>, q̈<sub>r</sub>)");
        check("(J B^-1 J')^-1", "(J B⁻¹ Jᵀ)⁻¹");
        check("d(ddq)/d(dq)", "∂q̈/∂q̇");
        check("dtau/dq", "∂τ/∂q");
        check("dJ/dt(q, dq)", "dJ/dt(q, q̇)");
        check("<b>", "&lt;b&gt;");
        assert_eq!(in_words("forward_dynamics_derivatives_by_dq"), "forward dynamics derivatives by q̇");
    }
}
