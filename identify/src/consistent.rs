//! Bodies that exist: standard parameters with positive pseudo-inertias, nearest to the description's where the logs do not decide.
//!
//! ```text
//! minimise  f(x) + mu sum_i D(J_i(x) | R_i)       over bodies, rotor inertias and friction
//! f(x) = ½ z'Gz - g'z + ½ b'Wb,  z = (T phi, friction)        D(J | R) = tr(R^-1 J) - log det J + log det R - 4
//! ```
//!
//! G and g are the reduced data of the logs. J_i = [[S, h], [h', m]] is the pseudo-inertia of link i, R_i that of the description's body.
//! D is the divergence of Lee, Wensing and Park (2020); -log det keeps every J_i positive definite (Wensing, Kim and Slotine 2018).
//! A rotor inertia is a pseudo-inertia of one row. Newton's method with a logarithmic barrier at 0 for friction that brakes.

use nalgebra::{DMatrix, DVector, Matrix3, Matrix4, Vector3};

use crate::arm::Arm;
use crate::body::{self, Ten};
use crate::identify::Reduced;

/// Consistent parameters.
#[derive(Clone, Debug, Default)]
pub struct Consistent {
    /// The body of each link, without those attached to it.
    pub bodies: Vec<Ten>,
    /// Rotor inertias, in the order of `Arm::rotors`.
    pub rotors: Vec<f64>,
    /// Friction, in the order of `Reduced::friction`.
    pub friction: Vec<f64>,
    /// f of these.
    pub objective: f64,
    /// The least f.
    pub unconstrained: f64,
    /// The weight of D.
    pub mu: f64,
    /// The weight of the barrier at the end.
    pub nu: f64,
    /// Steps of Newton's method.
    pub steps: usize,
}

impl Consistent {
    /// The base parameters that these bodies and rotors give, with what is attached.
    pub fn base(&self, arm: &Arm) -> DVector<f64> {
        let own = self.bodies.iter().zip(&arm.links);
        let bodies = own.flat_map(|(own, link)| (0..10).map(|k| own[k] + link.attached[k]));
        &arm.combination * DVector::from_iterator(arm.standard.len(), bodies.chain(self.rotors.iter().copied()))
    }
}

/// What D may cost, over the least f.
const COST: f64 = 1e-3;

/// How far consistent parameters are above the least f, over what errors of the estimate explain; and over the least f the rise by joint. The
/// parameters that exist are a convex set: where the truth is one of them, the nearest is no farther from the estimate than the truth.
pub fn rise(arm: &Arm, reduced: &Reduced, found: &Consistent) -> (f64, Vec<f64>) {
    let explained = 0.5 * reduced.reach + 2.0 * COST * found.unconstrained;
    let base = arm.base.len();
    let mut start = DVector::zeros(base + reduced.friction.len());
    start.rows_mut(0, base).copy_from(&(&arm.combination * arm.nominal()));
    let z = DVector::from_iterator(start.len(), found.base(arm).iter().chain(&found.friction).copied());
    let d = z - crate::fit::solve(&reduced.gram, &start).x;
    let of = |(h, score): &(DMatrix<f64>, DVector<f64>)| (0.5 * d.dot(&(h * &d)) - d.dot(score)) / found.unconstrained;
    ((found.objective - found.unconstrained) / explained.max(f64::MIN_POSITIVE), reduced.of_joints.iter().map(of).collect())
}

/// Whether a matrix is positive definite, by much more than rounding.
fn is_positive(j: &Matrix4<f64>) -> bool {
    let scale = Vector3::new(j[(0, 0)], j[(1, 1)], j[(2, 2)]).max().max(1e-300).sqrt();
    let d = Matrix4::from_diagonal(&nalgebra::Vector4::new(
        1.0 / scale,
        1.0 / scale,
        1.0 / scale,
        1.0 / j[(3, 3)].max(1e-300).sqrt(),
    ));
    (d * j * d).symmetric_eigenvalues().min() > 1e-6
}

/// The part of other masses that a body has whose mass is 0 in the description: it is counted elsewhere.
const LITTLE: f64 = 0.01;

/// The bodies that D refers to: the description's, and where one has no extent a cylinder between the joints of its link.
pub fn references(arm: &Arm) -> Vec<Ten> {
    let masses: Vec<f64> = arm.links.iter().map(|link| link.own[0]).filter(|mass| *mass > 0.0).collect();
    let mean = if masses.is_empty() { 1.0 } else { masses.iter().sum::<f64>() / masses.len() as f64 };
    let reference = |link: &crate::arm::Link| {
        if is_positive(&body::pseudo_inertia(&link.own)) {
            return link.own;
        }
        if link.attachments > 0 && is_positive(&body::pseudo_inertia(&link.attached)) {
            return link.attached.map(|x| LITTLE * x);
        }
        let [start, end] = link.ends;
        // A link between coincident joints has the size of a hand.
        let (length, mass) = ((end - start).norm().max(0.1), if link.own[0] > 0.0 { link.own[0] } else { LITTLE * mean });
        let along = (end - start).try_normalize(1e-9).unwrap_or_else(Vector3::z);
        let radius = 0.25 * length;
        let (axial, across) = (0.5 * radius * radius, (0.25 * radius * radius) + length * length / 12.0);
        let tensor = mass * (Matrix3::identity() * across + along * along.transpose() * (axial - across));
        let com = if link.own[0] > 0.0 && link.own[1..4].iter().any(|h| *h != 0.0) {
            Vector3::new(link.own[1], link.own[2], link.own[3]) / link.own[0]
        } else {
            0.5 * (start + end)
        };
        body::ten(mass, com, &tensor)
    };
    arm.links.iter().map(reference).collect()
}

/// What is minimised, in floats.
#[derive(Clone, Debug)]
pub(crate) struct Problem {
    /// Rows of z by columns of x.
    map: DMatrix<f64>,
    h: DMatrix<f64>,
    least: DVector<f64>,
    /// G z - g at `least`.
    rest: DVector<f64>,
    unconstrained: f64,
    links: usize,
    /// J of the units of a body.
    basis: [Matrix4<f64>; 10],
    /// Inverses of R.
    inverses: Vec<Matrix4<f64>>,
    /// Places of rotors with a reference, and it.
    rotors: Vec<(usize, f64)>,
    /// Places that are at least 0.
    bounded: Vec<usize>,
    offset: DVector<f64>,
}

/// Value, gradient and Hessian.
struct Value {
    phi: f64,
    gradient: DVector<f64>,
    hessian: DMatrix<f64>,
}

impl Problem {
    fn z(&self, x: &DVector<f64>) -> DVector<f64> {
        &self.map * x + &self.offset
    }

    fn f(&self, x: &DVector<f64>) -> f64 {
        let d = self.z(x) - &self.least;
        self.unconstrained + self.rest.dot(&d) + 0.5 * d.dot(&(&self.h * &d))
    }

    fn body(&self, x: &DVector<f64>, link: usize) -> Matrix4<f64> {
        (0..10).fold(Matrix4::zeros(), |j, k| j + self.basis[k] * x[10 * link + k])
    }

    /// f + mu D - nu (log det J + log of what is bounded); none outside.
    fn phi(&self, x: &DVector<f64>, mu: f64, nu: f64) -> Option<f64> {
        let mut phi = self.f(x);
        for link in 0..self.links {
            let j = self.body(x, link);
            let factor = j.cholesky()?;
            let log: f64 = 2.0 * (0..4).map(|k| factor.l_dirty()[(k, k)].ln()).sum::<f64>();
            phi += mu * (self.inverses[link] * j).trace() - (mu + nu) * log;
        }
        for &(place, reference) in &self.rotors {
            phi += mu * (x[place] / reference - (x[place] / reference).ln());
        }
        for &place in &self.bounded {
            if x[place] <= 0.0 {
                return None;
            }
            phi -= nu * x[place].ln();
        }
        phi.is_finite().then_some(phi)
    }

    fn value(&self, x: &DVector<f64>, mu: f64, nu: f64) -> Option<Value> {
        let phi = self.phi(x, mu, nu)?;
        let d = self.z(x) - &self.least;
        let mut gradient = self.map.transpose() * (&self.h * d + &self.rest);
        let mut hessian = self.map.transpose() * &self.h * &self.map;
        for link in 0..self.links {
            let inverse = self.body(x, link).try_inverse()?;
            let turned: [Matrix4<f64>; 10] = std::array::from_fn(|k| inverse * self.basis[k]);
            for k in 0..10 {
                gradient[10 * link + k] += mu * (self.inverses[link] * self.basis[k]).trace() - (mu + nu) * turned[k].trace();
                for l in 0..10 {
                    hessian[(10 * link + k, 10 * link + l)] += (mu + nu) * (turned[k] * turned[l]).trace();
                }
            }
        }
        for &(place, reference) in &self.rotors {
            gradient[place] += mu * (1.0 / reference - 1.0 / x[place]);
            hessian[(place, place)] += mu / (x[place] * x[place]);
        }
        for &place in &self.bounded {
            gradient[place] -= nu / x[place];
            hessian[(place, place)] += nu / (x[place] * x[place]);
        }
        Some(Value { phi, gradient, hessian })
    }

    /// z of the least f.
    pub(crate) fn least(&self) -> &DVector<f64> {
        &self.least
    }

    /// The least f.
    pub(crate) fn unconstrained(&self) -> f64 {
        self.unconstrained
    }

    /// The Hessian of phi at a point inside.
    pub(crate) fn hessian(&self, x: &DVector<f64>, mu: f64, nu: f64) -> Option<DMatrix<f64>> {
        self.value(x, mu, nu).map(|value| value.hessian)
    }

    /// Newton's method from a point inside; the number of steps.
    fn minimise(&self, x: &mut DVector<f64>, mu: f64, nu: f64) -> usize {
        for step in 0..80 {
            let Some(value) = self.value(x, mu, nu) else { return step };
            let n = x.len();
            // Columns differ by many powers of ten.
            let scale = DVector::from_fn(n, |i, _| 1.0 / value.hessian[(i, i)].max(1e-300).sqrt());
            let mut scaled = DMatrix::from_fn(n, n, |i, j| value.hessian[(i, j)] * scale[i] * scale[j]);
            (0..n).for_each(|i| scaled[(i, i)] += 1e-14);
            let Some(factor) = scaled.cholesky() else { return step };
            let direction = -factor.solve(&value.gradient.component_mul(&scale)).component_mul(&scale);
            let slope = value.gradient.dot(&direction);
            if -slope < 1e-9 * nu.max(1e-12 * value.phi.abs()) {
                return step;
            }
            let mut length = 1.0;
            let mut moved = false;
            for _ in 0..60 {
                let next = &*x + length * &direction;
                if self.phi(&next, mu, nu).is_some_and(|phi| phi <= value.phi + 1e-4 * length * slope + 1e-13 * value.phi.abs()) {
                    moved = next != *x;
                    *x = next;
                    break;
                }
                length *= 0.5;
            }
            if !moved {
                return step;
            }
        }
        80
    }
}

/// What is minimised for the reduced data.
pub(crate) fn problem(arm: &Arm, reduced: &Reduced) -> Problem {
    let (links, rotors, friction) = (arm.dof(), arm.rotors.len(), reduced.friction.len());
    let (base, n) = (arm.base.len(), 10 * arm.dof() + arm.rotors.len() + reduced.friction.len());
    let standard = 10 * links + rotors;
    let mut map = DMatrix::zeros(base + friction, n);
    map.view_mut((0, 0), (base, standard)).copy_from(&arm.combination);
    (0..friction).for_each(|k| map[(base + k, standard + k)] = 1.0);
    let attached = arm.links.iter().flat_map(|link| link.attached);
    let attached = DVector::from_iterator(standard, attached.chain(vec![0.0; rotors]));
    let mut offset = DVector::zeros(base + friction);
    offset.rows_mut(0, base).copy_from(&(&arm.combination * attached));
    let references = references(arm);
    let mut start = DVector::zeros(base + friction);
    start.rows_mut(0, base).copy_from(&(&arm.combination * arm.nominal()));
    let least = crate::fit::solve(&reduced.gram, &start).x;
    let rest = &reduced.gram.h * &least - &reduced.gram.g;
    let unit = |k: usize| body::pseudo_inertia(&std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 }));
    let inverse = |ten: &Ten| body::pseudo_inertia(ten).try_inverse().unwrap_or_else(Matrix4::identity);
    let given = arm.rotors.iter().enumerate().map(|(k, &joint)| (10 * links + k, arm.joints[joint].rotor));
    let bounded = reduced.friction.iter().enumerate().filter(|(_, (_, term))| term.is_not_negative());
    Problem {
        unconstrained: 0.5 * reduced.gram.squares(&least),
        h: reduced.gram.h.clone(),
        rest,
        links,
        basis: std::array::from_fn(unit),
        inverses: references.iter().map(inverse).collect(),
        rotors: given.filter(|(_, inertia)| *inertia > 0.0).collect(),
        bounded: (10 * links..standard).chain(bounded.map(|(k, _)| standard + k)).collect(),
        map,
        offset,
        least,
    }
}

/// The consistent parameters that explain the reduced data.
pub fn consistent(arm: &Arm, reduced: &Reduced) -> Consistent {
    let problem = problem(arm, reduced);
    let (links, base, friction) = (arm.dof(), arm.base.len(), reduced.friction.len());
    let (standard, n) = (arm.standard.len(), arm.standard.len() + friction);
    let references = references(arm);
    let given = arm.rotors.iter().enumerate().map(|(k, &joint)| (10 * links + k, arm.joints[joint].rotor));
    let mut x = DVector::zeros(n);
    for (link, ten) in references.iter().enumerate() {
        x.rows_mut(10 * link, 10).copy_from_slice(ten);
    }
    for (place, inertia) in given {
        x[place] = if inertia > 0.0 { inertia } else { 1e-5 };
    }
    for k in 0..friction {
        let value = problem.least[base + k];
        x[standard + k] = if problem.bounded.contains(&(standard + k)) { value.max(1e-3) } else { value };
    }
    let size = problem.unconstrained.max(1e-12 * reduced.gram.bb).max(1e-300);
    // Along the path of minima from far away, where D rules, to where the logs do.
    let mut steps = 0;
    let mut mu = problem.f(&x).max(size);
    while mu > 1e-3 * size {
        steps += problem.minimise(&mut x, mu, 1e-3 * mu);
        mu *= 0.1;
    }
    mu = 1e-3 * size;
    steps += problem.minimise(&mut x, mu, 1e-3 * mu);
    // D may cost a thousandth of what is least.
    for _ in 0..9 {
        let mut next = x.clone();
        steps += problem.minimise(&mut next, 0.1 * mu, 1e-4 * mu);
        if problem.f(&x) <= (1.0 + COST) * problem.f(&next) {
            break;
        }
        (x, mu) = (next, 0.1 * mu);
    }
    let least_nu = 1e-9 * size;
    let mut nu = 1e-3 * mu;
    while nu > least_nu {
        nu = (0.1 * nu).max(least_nu);
        steps += problem.minimise(&mut x, mu, nu);
    }
    Consistent {
        bodies: (0..links).map(|link| std::array::from_fn(|k| x[10 * link + k])).collect(),
        rotors: (10 * links..standard).map(|k| x[k]).collect(),
        friction: (standard..n).map(|k| x[k]).collect(),
        objective: problem.f(&x),
        unconstrained: problem.unconstrained,
        mu,
        nu: least_nu,
        steps,
    }
}
