//! The entries of an item, derived by the recursion over the links, before they have a form; or why they are missing.

use crate::catalogue::quantities::regressor::{KNOWN_TORQUE, REGRESSOR};
use crate::catalogue::Quantity;
use crate::derive::arm::Arm;
use crate::derive::derivation::{Derivation, CLOSED_FORM_TERMS};
use crate::derive::determinant::minors::{minors, NoMinors, Product};
use crate::derive::determinant::{determinant, Factor};
use crate::derive::motion::Motion;
use crate::derive::newton_euler::inverse_dynamics;
use crate::derive::parameters::{ParameterKind, View};
use crate::derive::regressor::{derivative_by_parameter, regressor};
use crate::ring::normal_form::NormalForm;
use crate::ring::print::{Notation, Printer};
use crate::ring::{ExprId, Pool, Symbol};
use crate::Model;

use super::{Item, Reading};

/// The content of an item, before it has a form.
pub(super) struct Derived {
    pub(super) derivation: Derivation,
    /// Factors of the determinant.
    pub(super) factored: Option<Factored>,
}

/// The determinant of the task Jacobian, or its minors.
pub(super) enum Factored {
    /// Its closed form where it is short, and its factors.
    Determinant(Option<NormalForm>, Vec<Factor>),
    /// The common factors of all minors, and the remaining factor of each.
    Minors(Vec<Factor>, Vec<Product>),
}

/// The entries of an item, or why they are missing.
pub(super) fn derived(model: &Model, item: Item, reading: Reading) -> Result<Derived, String> {
    let view = match (item, reading) {
        (Item::With(_), _) => View::Vector(&model.parameters),
        (_, Reading::Nominal) => View::Nominal,
        (_, Reading::Symbolic) => View::Symbolic,
    };
    let (quantity, with) = match item {
        Item::Determinant if !model.manipulator.tips.is_empty() => return Err(SEVERAL_JACOBIANS.into()),
        Item::Determinant => {
            let of = |pool, entries| Derivation { pool, entries, method: "minors", parallel: Vec::new() };
            return Ok(match determinant(model, view) {
                Some(found) => {
                    let closed = found.form.filter(|form| form.len() <= CLOSED_FORM_TERMS);
                    let factored = Factored::Determinant(closed, found.factors);
                    Derived { derivation: of(found.pool, vec![found.value]), factored: Some(factored) }
                }
                None => {
                    let found = minors(model, view).map_err(|why| no_minors(model, &why))?;
                    let factored = Factored::Minors(found.common, found.left);
                    Derived { derivation: of(found.pool, found.values), factored: Some(factored) }
                }
            });
        }
        Item::Plain(quantity) | Item::Element(quantity, _) => (quantity, false),
        Item::With(quantity) => (quantity, true),
    };
    quantity.absence(model, with).map_or(Ok(()), Err)?;
    let plain = matches!(item, Item::Plain(_));
    let of_names = plain && [&REGRESSOR, &KNOWN_TORQUE].contains(&quantity) && reading == Reading::Symbolic;
    let derivation = if of_names { symbolic_regressor(model, quantity) } else { None };
    Ok(Derived { derivation: derivation.unwrap_or_else(|| quantity.by_recursion(model, view)), factored: None })
}

/// Y or the known rest with all names of the description as symbols: Y_k = ∂tau/∂name_k, and the rest is tau - Y pi.
///
/// `None` for the known torque of a base parameter set: its combinations hold the description's numbers.
fn symbolic_regressor(model: &Model, quantity: &Quantity) -> Option<Derivation> {
    let (manipulator, vector) = (&model.manipulator, &model.parameters);
    let sizes = model.sizes_with(0);
    let mut pool = Pool::new(model.field.clone());
    let arm = Arm::new(&mut pool, manipulator, View::Symbolic);
    let motion = Motion::with_reference(&mut pool, &arm);
    let (y, pi): (Vec<Vec<ExprId>>, Vec<ExprId>) = match &vector.kind {
        ParameterKind::Names(names) => {
            let tau = inverse_dynamics(&mut pool, &arm, &motion);
            let symbols: Vec<u16> = names.iter().map(|id| id.0 as u16).collect();
            let columns: Vec<_> = symbols.iter().map(|&k| derivative_by_parameter(&mut pool, &tau, k)).collect();
            let y = (0..arm.dof()).map(|i| columns.iter().map(|column| column[i]).collect()).collect();
            (y, symbols.into_iter().map(|k| pool.symbol(Symbol::Parameter(k))).collect())
        }
        ParameterKind::Standard(all) => {
            let pi = all.iter().map(|&p| View::Symbolic.standard(&mut pool, manipulator, p)).collect();
            (regressor(&mut pool, &arm, vector), pi)
        }
        ParameterKind::Base(_) if *quantity == REGRESSOR => (regressor(&mut pool, &arm, vector), Vec::new()),
        ParameterKind::Base(_) => return None,
    };
    let entries = if *quantity == REGRESSOR {
        y.concat()
    } else {
        let tau = inverse_dynamics(&mut pool, &arm, &motion);
        tau.iter()
            .zip(&y)
            .map(|(&tau, row)| {
                let known = pool.dot(row, &pi);
                pool.sub(tau, known)
            })
            .collect()
    };
    // Of the regressor a row for each joint, of the rest an entry.
    let entries = quantity.of_coordinates(&mut pool, &arm, &sizes, entries);
    let (pool, entries) = arm.in_coordinates(pool, entries);
    Some(Derivation { pool, entries, method: "derivatives by the names", parallel: Vec::new() })
}

/// Why an arm with named end effectors has no determinant.
const SEVERAL_JACOBIANS: &str = "each end effector has a Jacobian of its own, which the joints of other branches do not enter";

/// Refers to the page that checks a posture for singularity where no formula does.
pub const ASK_THE_PAGE: &str =
    "`armgen page ROBOT.yaml --out robot.html` shows w = sqrt(det(J J')) at any posture, 0 where J loses rank";

/// Why there are no minors, and what to do instead.
fn no_minors(model: &Model, why: &NoMinors) -> String {
    let (rows, joints) = (model.manipulator.task.len(), model.manipulator.dof());
    let number = |n: usize, of: &str| format!("{n} {of}{}", if n == 1 { "" } else { "s" });
    let (rows, joints) = (number(rows, "row"), number(joints, "joint"));
    let head = format!("the task has {rows} and the arm {joints}: ");
    const FEWER: &str = "name fewer rows under `task`";
    match why {
        NoMinors::NotRedundant | NoMinors::AllZero => format!("{head}its Jacobian never has as many independent rows; {FEWER}"),
        NoMinors::TooMany => format!("{head}its Jacobian is not square; {ASK_THE_PAGE}"),
        NoMinors::TooLong(common) if common.is_empty() => {
            format!("{head}the minors of its Jacobian are too long; {ASK_THE_PAGE}")
        }
        NoMinors::TooLong(common) => {
            let parameters: Vec<String> = model.manipulator.parameters.iter().map(|parameter| parameter.name.clone()).collect();
            let printer =
                Printer { notation: Notation::Text, parameters: &parameters, velocities: &[], computed: None, digits: None };
            let factor = |factor: &Factor| format!("{} is {}", printer.form(&factor.form), factor.zeros.sentence());
            let common = common.iter().map(factor).collect::<Vec<_>>().join(", ");
            format!("{head}its Jacobian loses rank where a factor of all its minors is 0 ({common}); what is left of these is too long; {ASK_THE_PAGE}")
        }
    }
}
