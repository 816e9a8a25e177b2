//! Identities among the functions of a module, independent of the checker's own equations. Where an identity needs a derivative, the emitted
//! functions run in dual numbers.

use crate::certificate::report::{FunctionReport, IdentityReport};
use crate::judge::checker::{with_parameters, Checker, Point};
use crate::read::reader::Module;
use crate::textbook::equations::parameters::Vector;
use crate::textbook::equations::state::State;
use crate::textbook::reference::{BASE_REGRESSOR, PROMISES};
use crate::values::arithmetic::dual::Dual;
use crate::values::arithmetic::prime::{Prime, Residue};
use crate::values::check::parallel_map;
use crate::values::element::Element;
use crate::values::formula::Formula;
use crate::values::program::Program;

/// The functions of a module with the exact values of their literals, at one point.
struct Running<'a> {
    module: &'a Module,
    reports: &'a [FunctionReport],
    point: &'a Point<Prime>,
    nominal: &'a [Formula],
    nominal_base: &'a [Formula],
}

/// The reason for skipping an identity whose functions are missing in the module.
pub(crate) const ABSENT: &str = "the module does not have its functions";

type Entries = Vec<Residue>;
type Rates = Dual<Residue>;

impl Running<'_> {
    fn program(&self, name: &str) -> Result<(&Program, Entries), String> {
        if !self.has(name) {
            return Err(ABSENT.into());
        }
        let missing = || format!("`{name}` has no exact values");
        let program = self.module.program(name).ok_or_else(missing)?;
        let report = self.reports.iter().find(|r| r.name == name).ok_or_else(missing)?;
        let formulas: Vec<Formula> = report.literals.iter().map(|literal| literal.value.clone()).collect();
        if formulas.len() != program.literals.len() {
            return Err(missing());
        }
        let literals = self.point.literals_of(program, &formulas).ok_or_else(missing)?;
        Ok((program, literals))
    }

    fn has(&self, name: &str) -> bool {
        self.module.functions.iter().any(|(other, _)| other == name)
    }

    fn run(&self, name: &str, state: &State<Residue>) -> Result<Entries, String> {
        let (program, literals) = self.program(name)?;
        let entries: Option<Entries> = program.run(state, &literals).into_iter().collect();
        entries.ok_or(format!("`{name}` has no value"))
    }

    /// The rates of change of a function's entries.
    fn rates(&self, name: &str, state: &State<Rates>) -> Result<Entries, String> {
        let (program, literals) = self.program(name)?;
        let literals: Vec<Rates> = literals.iter().map(Dual::constant).collect();
        let entries: Option<Entries> = program.run(state, &literals).into_iter().map(|e| Some(e?.rate)).collect();
        entries.ok_or(format!("`{name}` has no value"))
    }

    /// Torques without load-dependent friction, for modules that have it.
    fn without_load_friction(&self, torques: Entries, state: &State<Residue>) -> Result<Entries, String> {
        if !self.has("load_friction") {
            return Ok(torques);
        }
        Ok(torques.iter().zip(&self.run("load_friction", state)?).map(|(torque, load)| torque.minus(load)).collect())
    }

    fn state(&self) -> &State<Residue> {
        &self.point.reference.state
    }

    fn nominal(&self) -> Result<Entries, String> {
        self.point.literals(self.nominal).ok_or("the nominal parameters are not known".into())
    }
}

fn dot(a: &[Residue], b: &[Residue]) -> Residue {
    a.iter().zip(b).map(|(a, b)| a.times(b)).reduce(|a, b| a.plus(&b)).expect("at least one joint")
}

fn rows(m: &[Residue], v: &[Residue]) -> Entries {
    m.chunks(v.len()).map(|row| dot(row, v)).collect()
}

fn sum(a: &[Residue], b: &[Residue]) -> Entries {
    a.iter().zip(b).map(|(a, b)| a.plus(b)).collect()
}

type Identity = (&'static str, fn(&Running<'_>) -> Result<bool, String>);

const IDENTITIES: [Identity; 10] = [
    ("B = B'", |run| {
        let b = run.run("inertia_matrix", run.state())?;
        let n = run.state().q.len();
        Ok((0..n).all(|i| (0..n).all(|j| b[i * n + j] == b[j * n + i])))
    }),
    ("dB/dt - 2C = -(dB/dt - 2C)'", |run| {
        let state = run.state();
        let n = state.q.len();
        let moving = state.moving(&state.dq, &state.ddq);
        let (rate, c) = (run.rates("inertia_matrix", &moving)?, run.run("coriolis_matrix", state)?);
        let skew: Entries = rate.iter().zip(&c).map(|(b, c)| b.minus(&c.plus(c))).collect();
        Ok((0..n).all(|i| (0..n).all(|j| skew[i * n + j].plus(&skew[j * n + i]).is_zero())))
    }),
    ("Y pi + tau_known = tau", |run| {
        let mut state = run.state().clone();
        state.dqr.clone_from(&state.dq);
        state.ddqr.clone_from(&state.ddq);
        let (y, known) = (run.run("regressor", &state)?, run.run("known_torque", &state)?);
        let nominal = run.nominal()?;
        let tau = run.without_load_friction(run.run("inverse_dynamics", &state)?, &state)?;
        Ok(nominal.is_empty() && known == tau || !nominal.is_empty() && sum(&rows(&y, &nominal), &known) == tau)
    }),
    ("Y_b pi_b = tau", |run| {
        let state = run.state();
        let y = run.run(BASE_REGRESSOR, state)?;
        let nominal = run.point.literals(run.nominal_base).ok_or("the nominal base parameters are not known")?;
        let tau = run.without_load_friction(run.run("inverse_dynamics", state)?, state)?;
        let n = tau.len();
        Ok(y.len() == n * nominal.len() && (nominal.is_empty() || rows(&y, &nominal) == tau))
    }),
    ("g = dU/dq", |run| {
        let state = run.state();
        let g = run.run("gravity", state)?;
        for (k, g) in g.iter().enumerate() {
            let mut along = vec![state.zero; state.q.len()];
            along[k] = state.one;
            let moving = state.moving(&along, &vec![state.zero; state.q.len()]);
            if run.rates("potential_energy", &moving)?[0] != *g {
                return Ok(false);
            }
        }
        Ok(true)
    }),
    ("T = 1/2 dq'B dq", |run| {
        let state = run.state();
        let (t, b) = (run.run("kinetic_energy", state)?[0], run.run("inertia_matrix", state)?);
        Ok(t.plus(&t) == dot(&rows(&b, &state.dq), &state.dq))
    }),
    ("d(T + U)/dt = dq'(tau - F)", |run| {
        let state = run.state();
        let moving = state.moving(&state.dq, &state.ddq);
        let power = run.rates("kinetic_energy", &moving)?[0].plus(&run.rates("potential_energy", &moving)?[0]);
        let (tau, f) = (run.run("inverse_dynamics", state)?, run.run("friction", state)?);
        let net = run.without_load_friction(tau.iter().zip(&f).map(|(tau, f)| tau.minus(f)).collect(), state)?;
        Ok(power == dot(&net, &state.dq))
    }),
    ("forward dynamics inverts inverse dynamics", |run| {
        let mut state = run.state().clone();
        state.tau = run.run("inverse_dynamics", &state)?;
        Ok(run.run("forward_dynamics", &state)? == state.ddq)
    }),
    ("dJ/dt is the rate of J along dq", |run| {
        let state = run.state();
        let moving = state.moving(&state.dq, &state.ddq);
        let names = run.point.reference.values.keys().filter_map(|name| name.strip_suffix("geometric_jacobian_dot"));
        let there: Vec<&str> = names.filter(|tip| run.has(&format!("{tip}geometric_jacobian_dot"))).collect();
        let mut holds = if there.is_empty() { Err(ABSENT.into()) } else { Ok(true) };
        for tip in there {
            let [jacobian, rate] = ["", "_dot"].map(|end| format!("{tip}geometric_jacobian{end}"));
            holds = Ok(holds? && run.rates(&jacobian, &moving)? == run.run(&rate, state)?);
        }
        holds
    }),
    ("equations_of_motion = (B, C, g)", |run| {
        let state = run.state();
        let parts = ["inertia_matrix", "coriolis_matrix", "gravity"].map(|name| run.run(name, state));
        let [b, c, g] = parts;
        Ok(run.run("equations_of_motion", state)? == [b?, c?, g?].concat())
    }),
];

/// Checks all identities of a module with readable functions and known literals.
pub fn check(checker: &Checker, module: &Module, reports: &[FunctionReport], nominal: &[Formula]) -> Vec<IdentityReport> {
    let nominal_base = checker.base().map_or(&[][..], |base| &base.nominal);
    let over_points = |holds: &dyn Fn(&Running<'_>) -> Result<bool, String>| {
        for point in checker.points() {
            if !holds(&Running { module, reports, point, nominal, nominal_base })? {
                return Ok(false);
            }
        }
        Ok(true)
    };
    let points = checker.points().len();
    let mut identities =
        parallel_map(&IDENTITIES, |(name, holds)| IdentityReport { name: (*name).into(), holds: over_points(holds), points });
    identities.retain(|identity| identity.holds.as_ref().err().is_none_or(|why| why != ABSENT));
    let base = matches!(checker.vector(), Vector::Base(..));
    let at_nominal = |run: &Running<'_>| -> Result<bool, String> {
        let state = with_parameters(run.state(), run.nominal()?);
        for promise in PROMISES.iter().filter(|p| p.parameters && !(base && p.name == "potential_energy")) {
            let with = format!("{}_with", promise.name);
            if run.has(promise.name) && run.has(&with) && run.run(promise.name, &state)? != run.run(&with, &state)? {
                return Ok(false);
            }
        }
        Ok(true)
    };
    identities.push(IdentityReport {
        name: "functions at run-time parameters, at the nominal ones, are the plain functions".into(),
        holds: over_points(&at_nominal),
        points,
    });
    identities.push(IdentityReport {
        name: "the checker's equations after Lagrange and after Newton and Euler agree".into(),
        holds: Ok(checker.derivations_agree()),
        points,
    });
    identities
}
