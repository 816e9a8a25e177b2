//! The operational-space inertia: the apparent inertia of the end effector along and about the rows of the task.
//!
//! ```text
//! B_A = (J B^-1 J')^-1                                              (the book, Sect. 7.8, with the rows of J that make up the task)
//! ```
//!
//! B = L D L' gives J B^-1 J' = (L^-1 J')' D^-1 (L^-1 J') without B^-1, and the inverse of that comes from its own factors.
//! There is none where the rows of J depend on each other: at singular configurations, where a reciprocal is infinite, and for every q
//! where the task asks for more than the arm can do ([`is_defined`]).

use super::inertia::inertia_matrix;
use super::kinematics::geometric_jacobian;
use crate::derive::arm::Arm;
use crate::derive::factors::LdlFactors;
use crate::derive::model::Model;
use crate::derive::parameters::View;
use crate::derive::passes::RewriteScope;
use crate::derive::plan::Plan;
use crate::derive::quantity::{Argument, Documentation, Length, Of, Quantity, Recursion, ResultPart, Typeset};
use crate::pass::Pass;
use crate::ring::field::{Element, Field};
use crate::ring::{ExprId, Pool};

/// (J B^-1 J')^-1 of the rows of the task.
pub static OPERATIONAL_INERTIA: Quantity = Quantity {
    name: "operational_inertia",
    symbol: Typeset::new("(J B^-1 J')^-1", "(J B^{-1} J^T)^{-1}"),
    arguments: &[Argument::Q],
    result: &[ResultPart::whole(Typeset::new("(J B^-1 J')^-1", "(J B^{-1} J^T)^{-1}"), Typeset::new("b_a", "b_A"), &[Length::Task, Length::Task], "kg, kg m, kg m²")],
    structure: None,
    has_parameters: false,
    documentation: Documentation { failure: ["not finite where J is singular"; 2], ..Documentation::new(
        "Inertia of the end effector along and about the rows of the task, in the base frame.",
        "B_A(q) = (J B(q)^-1 J')^-1, J the rows {TASK} of the geometric Jacobian (Siciliano et al., Sect. 7.8)",
        "`b[row][column]` in the order of {TASK}, symmetric; kg, kg m, kg m². Positive definite where those rows of J are independent; at a singular \
         configuration it is infinite, and its entries are not finite or, by rounding, very large.",
    ) },
    recursion: Recursion { // The Jacobian wants the lengths of the description.
        without: &[Pass::UnitOfLength], of: Of::EndEffector, ..Recursion::new(RewriteScope::Dynamics, |pool, arm, plan, input| {
            operational_inertia(pool, arm, plan, &input.model.manipulator.task_rows()).concat()
        }) },
    missing,
    gathers: &[],
    interface: Some("OperationalInertia"),
};

/// (J B^-1 J')^-1, all entries, for the rows of the task; only where it [`is_defined`].
pub fn operational_inertia(pool: &mut Pool, arm: &Arm, plan: &mut Plan, task: &[usize]) -> Vec<Vec<ExprId>> {
    let jacobian = geometric_jacobian(pool, arm);
    let rows: Vec<Vec<ExprId>> = task.iter().map(|&row| jacobian[row].clone()).collect();
    let rows = arm.project_columns(pool, rows);
    let b = inertia_matrix(pool, arm, plan);
    let b = arm.project_matrix(pool, b);
    let mobility = LdlFactors::of_inertia(pool, arm, &b).congruent(pool, &rows);
    LdlFactors::new(pool, &mobility).inverse(pool)
}

/// The reason why an arm lacks the function.
fn missing(model: &Model, with_parameters: bool) -> Option<String> {
    if let Some(reason) = Quantity::MISSING_WITHOUT_MASS(model, with_parameters) {
        return Some(reason);
    }
    let task = model.manipulator.task_rows();
    let mut pool = Pool::new(model.field.clone());
    let arm = Arm::new(&mut pool, &model.manipulator, View::Nominal);
    (!is_defined(&model.field, &arm, pool, &task)).then(|| {
        let (rows, joints) = (task.len(), model.manipulator.dof());
        format!(
            "J B^-1 J' is singular for every q: the arm's {joints} joints cannot move the {rows} rows of the task independently"
        )
    })
}

/// Whether the rows of the task are independent but for singular configurations.
pub fn is_defined(field: &Field, arm: &Arm, mut pool: Pool, task: &[usize]) -> bool {
    let jacobian = geometric_jacobian(&mut pool, arm);
    let jacobian = arm.project_columns(&mut pool, jacobian);
    let (pool, jacobian) = arm.in_coordinates(pool, jacobian.concat());
    let columns = arm.coordinates();
    let mut rows: Vec<Vec<Element>> =
        task.iter().map(|&row| jacobian[row * columns..][..columns].iter().map(|&e| pool.fingerprint(e)[0]).collect()).collect();
    let mut rank = 0;
    for column in 0..columns {
        let Some(found) = (rank..rows.len()).find(|&r| rows[r][column] != field.zero()) else { continue };
        rows.swap(rank, found);
        let pivot = rows[rank].clone();
        let inverse = field.inverse(pivot[column]);
        for row in &mut rows[rank + 1..] {
            let factor = field.mul(row[column], inverse);
            for (x, &p) in row.iter_mut().zip(&pivot) {
                *x = field.sub(*x, field.mul(factor, p));
            }
        }
        rank += 1;
    }
    rank == task.len()
}
