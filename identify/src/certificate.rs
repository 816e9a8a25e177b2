//! The certificate of identified numbers: every body is possible, and no other bodies explain the logs better by more than a proved gap.
//!
//! ```text
//! phi(x) = ½ |U z - c|² + k + mu sum_i D(J_i | R_i),     z = (T phi_x + attached, friction)
//! phi(y) >= phi(x) + grad phi(x)'(y - x) >= phi(x) - gap,     gap = sum_i <S_i, J_i(x)> + s'x,     for all y
//! ```
//!
//! U, c, k, mu, R and x are floats of the certificate, so fractions. phi is convex by its form. S_i is the matrix with <S_i, dJ_i/dx_k> the
//! k-th entry of grad phi, s is grad phi of what is at least 0. With S_i positive semidefinite and s >= 0 the second inequality holds. Where
//! friction may have either sign, x is the exact minimum. From x to the numbers w of the file phi rises by at most
//! f(w) - f(x) + mu (tr R^-1 (J_w - J_x) + det J_x / det J_w - 1), since log r <= r - 1. Nothing is rounded.

use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::exact::{Number, Polynomial, Rational};
use armgen_codegen::manipulator::{Body, Manipulator};
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use nalgebra::{DMatrix, DVector, SymmetricEigen};
use serde_json::{json, Value};
use sha2::{Digest, Sha256};

use crate::arm::Arm;
use crate::consistent::{problem, references, Consistent, Problem};
use crate::exact::{dot, fraction, inverse, is_definite, is_negative, is_positive, pivots, solve, trace_of_product, Matrix};
use crate::identify::{Identified, Reduced};
use crate::prepare::Friction;
use crate::written::{write_finer, Written};

/// The format, which begins every certificate.
pub const FORMAT: &str = "armgen identification 1";

/// The largest gap that counts as optimal, relative to the objective.
pub const LARGEST_GAP: f64 = 1e-6;

/// What a certificate proves.
#[derive(Clone, Debug, PartialEq)]
pub struct Proved {
    /// Links with a positive definite pseudo-inertia: all of the arm.
    pub bodies: usize,
    /// An upper bound of the relative gap of optimality; or the reason why there is none.
    pub gap: Result<f64, String>,
}

/// The data of phi.
struct Data {
    base: usize,
    standard: usize,
    links: usize,
    /// Rows of T, without zeros.
    map: Vec<Vec<(usize, Rational)>>,
    offset: Vec<Rational>,
    /// Upper triangle.
    u: Matrix,
    c: Vec<Rational>,
    least: Rational,
    mu: Rational,
    /// Inverses of R.
    inverses: Vec<Matrix>,
    /// Places of rotor inertias with a reference.
    rotors: Vec<(usize, Rational)>,
    /// Places that are at least 0, and those of either sign.
    bounded: Vec<usize>,
    free: Vec<usize>,
}

/// A point, grad phi as matrices and numbers, and the gap.
struct Dual {
    x: Vec<Rational>,
    /// S of each link, and the inverse of J.
    links: Vec<(Matrix, Matrix)>,
    /// s of what is bounded.
    bounded: Vec<Rational>,
}

fn one() -> Rational {
    Rational::ONE
}

fn half() -> Rational {
    Rational::from_parts(1.into(), 2u8.into())
}

/// [[S, h], [h', m]] of ten numbers about the frame's origin.
fn pseudo_inertia(ten: &[Rational]) -> Matrix {
    let [m, hx, hy, hz, xx, xy, yy, xz, yz, zz] = ten else { unreachable!("ten numbers") };
    let trace = (xx + yy + zz) * half();
    let row = |a: Rational, b: Rational, c: Rational, d: &Rational| vec![a, b, c, d.clone()];
    vec![
        row(&trace - xx, -xy.clone(), -xz.clone(), hx),
        row(-xy.clone(), &trace - yy, -yz.clone(), hy),
        row(-xz.clone(), -yz.clone(), &trace - zz, hz),
        row(hx.clone(), hy.clone(), hz.clone(), m),
    ]
}

/// The symmetric matrix whose products with the J of unit parameters are these ten.
fn dual_of(g: &[Rational]) -> Matrix {
    let [m, hx, hy, hz, xx, xy, yy, xz, yz, zz] = g else { unreachable!("ten numbers") };
    let half = |x: &Rational| x * half();
    let (h, p) = ([half(hx), half(hy), half(hz)], [-half(xy), -half(xz), -half(yz)]);
    vec![
        vec![yy + zz, p[0].clone(), p[1].clone(), h[0].clone()],
        vec![p[0].clone(), xx + zz, p[2].clone(), h[1].clone()],
        vec![p[1].clone(), p[2].clone(), xx + yy, h[2].clone()],
        vec![h[0].clone(), h[1].clone(), h[2].clone(), m.clone()],
    ]
}

fn combined(a: &Matrix, factor: &Rational, b: &Matrix) -> Matrix {
    a.iter().zip(b).map(|(a, b)| a.iter().zip(b).map(|(a, b)| a + factor * b).collect()).collect()
}

impl Data {
    fn body(&self, x: &[Rational], link: usize) -> Matrix {
        pseudo_inertia(&x[10 * link..10 * link + 10])
    }

    /// U z - c.
    fn residual(&self, x: &[Rational]) -> Vec<Rational> {
        let mut z: Vec<Rational> = (0..self.base)
            .map(|row| self.map[row].iter().fold(self.offset[row].clone(), |sum, (place, t)| sum + t * &x[*place]))
            .collect();
        z.extend_from_slice(&x[self.standard..]);
        self.u.iter().zip(&self.c).map(|(row, c)| dot(row, &z) - c).collect()
    }

    fn f(&self, x: &[Rational]) -> Rational {
        let r = self.residual(x);
        dot(&r, &r) * half() + &self.least
    }

    /// The point with the exact minimum over friction of either sign, and grad phi there; an error outside of what phi is defined on.
    fn dual(&self, x: &[Rational]) -> Result<Dual, String> {
        let mut x = x.to_vec();
        let column = |k: usize| -> Vec<Rational> { self.u.iter().map(|row| row[k].clone()).collect() };
        let free: Vec<Vec<Rational>> = self.free.iter().map(|place| column(place - self.standard + self.base)).collect();
        if !free.is_empty() {
            let r = self.residual(&x);
            let h = free.iter().map(|a| free.iter().map(|b| dot(a, b)).collect()).collect();
            if !is_definite(&h) {
                return Err("the logs do not determine friction".to_owned());
            }
            let step = solve(&h, &free.iter().map(|a| vec![dot(a, &r)]).collect());
            self.free.iter().zip(step).for_each(|(place, step)| x[*place] = &x[*place] - &step[0]);
        }
        let r = self.residual(&x);
        let of_z: Vec<Rational> = (0..self.u.len()).map(|k| dot(&column(k), &r)).collect();
        let mut gradient = vec![Rational::ZERO; x.len()];
        for (row, g) in self.map.iter().zip(&of_z) {
            row.iter().for_each(|(place, t)| gradient[*place] = &gradient[*place] + t * g);
        }
        gradient[self.standard..].clone_from_slice(&of_z[self.base..]);
        let mut links = Vec::new();
        for link in 0..self.links {
            let j = self.body(&x, link);
            if !is_definite(&j) {
                return Err(format!("the point has no possible body for link {}", link + 1));
            }
            let inverse = inverse(&j);
            let s = dual_of(&gradient[10 * link..10 * link + 10]);
            let s = combined(&combined(&s, &self.mu, &self.inverses[link]), &-self.mu.clone(), &inverse);
            links.push((s, inverse));
        }
        for (place, reference) in &self.rotors {
            if !is_positive(&x[*place]) {
                return Err("the point has a rotor without inertia".to_owned());
            }
            gradient[*place] = &gradient[*place] + &self.mu * (one() / reference - one() / &x[*place]);
        }
        if self.bounded.iter().any(|place| !is_positive(&x[*place])) {
            return Err("the point has negative friction".to_owned());
        }
        let bounded = self.bounded.iter().map(|place| gradient[*place].clone()).collect();
        Ok(Dual { x, links, bounded })
    }

    /// An upper bound of phi(w) less its minimum.
    fn gap(&self, dual: &Dual, w: &[Rational]) -> Result<Rational, String> {
        let x = &dual.x;
        let mut gap = self.f(w) - self.f(x);
        for (link, (s, _)) in dual.links.iter().enumerate() {
            if !is_definite(s) {
                return Err(format!("the point is not optimal for link {}", link + 1));
            }
            let (jx, jw) = (self.body(x, link), self.body(w, link));
            let difference = combined(&jw, &-one(), &jx);
            let determinant = |j: &Matrix| pivots(j).iter().fold(one(), |product, pivot| product * pivot);
            if !is_definite(&jw) {
                return Err(format!("link {} has no possible body", link + 1));
            }
            let ratio = determinant(&jx) / determinant(&jw);
            gap += trace_of_product(s, &jx);
            gap += &self.mu * (trace_of_product(&self.inverses[link], &difference) + ratio - one());
        }
        for (place, reference) in &self.rotors {
            if !is_positive(&w[*place]) {
                return Err("a rotor has no inertia".to_owned());
            }
            gap += &self.mu * ((&w[*place] - &x[*place]) / reference + &x[*place] / &w[*place] - one());
        }
        for (place, s) in self.bounded.iter().zip(&dual.bounded) {
            if is_negative(s) || is_negative(&w[*place]) {
                return Err("the point is not optimal for friction".to_owned());
            }
            gap += s * &x[*place];
        }
        Ok(gap)
    }
}

/// Fractions of floats.
fn fractions(x: &[f64]) -> Result<Vec<Rational>, String> {
    x.iter().map(|x| fraction(*x).ok_or_else(|| "a number is not finite".to_owned())).collect()
}

/// What of phi the certificate has: all else follows from the description.
#[derive(Clone, Debug, Default, PartialEq)]
struct Stored {
    friction: Vec<(usize, Friction)>,
    references: Vec<Vec<f64>>,
    rotors: Vec<f64>,
    u: Vec<Vec<f64>>,
    c: Vec<f64>,
    least: f64,
    mu: f64,
    /// Each entry of the point as a sum of two floats.
    point: Vec<[f64; 2]>,
}

impl Stored {
    fn data(&self, arm: &Arm) -> Result<Data, String> {
        let (base, standard, links) = (arm.base.len(), arm.standard.len(), arm.dof());
        let (z, n) = (base + self.friction.len(), standard + self.friction.len());
        let fits = self.u.len() == z
            && self.u.iter().enumerate().all(|(k, row)| row.len() == z - k)
            && (self.c.len(), self.references.len(), self.rotors.len()) == (z, links, arm.rotors.len())
            && self.references.iter().all(|ten| ten.len() == 10)
            && self.point.len() == n;
        if !fits {
            return Err("its numbers are not as many as those of the description".to_owned());
        }
        if self.mu.is_nan() || self.mu <= 0.0 || self.least < 0.0 {
            return Err("the weight of the divergence is not positive".to_owned());
        }
        let attached: Vec<f64> = arm.links.iter().flat_map(|link| link.attached).chain(vec![0.0; arm.rotors.len()]).collect();
        let attached = fractions(&attached)?;
        let mut map = Vec::new();
        let mut offset = Vec::new();
        for row in 0..base {
            let filled = (0..standard).filter(|&place| arm.combination[(row, place)] != 0.0);
            let row: Result<Vec<_>, String> =
                filled.map(|place| Ok((place, fractions(&[arm.combination[(row, place)]])?.remove(0)))).collect();
            let row = row?;
            offset.push(row.iter().fold(Rational::ZERO, |sum, (place, t)| sum + t * &attached[*place]));
            map.push(row);
        }
        let mut u = Vec::new();
        for (k, row) in self.u.iter().enumerate() {
            u.push([vec![Rational::ZERO; k], fractions(row)?].concat());
        }
        let mut inverses = Vec::new();
        for ten in &self.references {
            let r = pseudo_inertia(&fractions(ten)?);
            if !is_definite(&r) {
                return Err("a reference is no possible body".to_owned());
            }
            inverses.push(inverse(&r));
        }
        let rotors = fractions(&self.rotors)?.into_iter().enumerate().filter(|(_, reference)| is_positive(reference));
        let is_bounded = |k: &usize| self.friction[k - standard].1.is_not_negative();
        Ok(Data {
            base,
            standard,
            links,
            map,
            offset,
            u,
            c: fractions(&self.c)?,
            least: fractions(&[self.least])?.remove(0),
            mu: fractions(&[self.mu])?.remove(0),
            inverses,
            rotors: rotors.map(|(k, reference)| (10 * links + k, reference)).collect(),
            bounded: (10 * links..standard).chain((standard..n).filter(is_bounded)).collect(),
            free: (standard..n).filter(|k| !is_bounded(k)).collect(),
        })
    }

    fn point(&self) -> Result<Vec<Rational>, String> {
        self.point.iter().map(|pair| Ok(fractions(pair)?.into_iter().fold(Rational::ZERO, |sum, x| sum + x))).collect()
    }

    /// The relative gap of written numbers, rounded up.
    fn gap(&self, arm: &Arm, written: &[Rational]) -> Result<f64, String> {
        let data = self.data(arm)?;
        let dual = data.dual(&self.point()?)?;
        let gap = data.gap(&dual, written)?;
        let relative = float_up(&(gap / data.f(written)));
        Ok(relative)
    }
}

/// A float with three digits, not below.
fn float_up(x: &Rational) -> f64 {
    let text = format!("{:.2e}", Number::from(x.clone()).to_f64() * 1.006);
    text.parse().unwrap_or(f64::INFINITY)
}

/// The numbers of a description over which phi is defined, where all are fractions.
fn written_of(manipulator: &Manipulator, arm: &Arm, friction: &[(usize, Friction)]) -> Result<Vec<Rational>, String> {
    let of = |value: &Polynomial, name: &str| {
        let number = nominal(manipulator, value);
        number.as_rational().cloned().ok_or_else(|| format!("numbers of joint `{name}` are not rational"))
    };
    let mut all = Vec::new();
    for joint in &manipulator.joints {
        let body = &joint.link.first().ok_or_else(|| format!("joint `{}` has no body", joint.name))?.body;
        let m = of(&body.mass, &joint.name)?;
        let mut c = Vec::new();
        for x in &body.com {
            c.push(of(x, &joint.name)?);
        }
        let mut i = Vec::new();
        for x in &body.inertia {
            i.push(of(x, &joint.name)?);
        }
        // Steiner: I + m (c'c 1 - c c').
        let square = dot(&c, &c);
        let about = |element: usize, a: usize, b: usize| {
            let part = if a == b { &square - &c[a] * &c[b] } else { -(&c[a] * &c[b]) };
            &i[element] + &m * part
        };
        let tensor = [about(0, 0, 0), about(1, 0, 1), about(2, 1, 1), about(3, 0, 2), about(4, 1, 2), about(5, 2, 2)];
        all.push(m.clone());
        all.extend(c.iter().map(|c| &m * c));
        all.extend(tensor);
    }
    let optional = |value: &Option<Polynomial>, name: &str| value.as_ref().map_or(Ok(Rational::ZERO), |value| of(value, name));
    for &joint in &arm.rotors {
        let joint = &manipulator.joints[joint];
        all.push(optional(&joint.motor.as_ref().and_then(|motor| motor.inertia.clone()), &joint.name)?);
    }
    for &(joint, term) in friction {
        let joint = &manipulator.joints[joint];
        let stribeck = joint.stribeck.as_ref().map(|stribeck| stribeck.torque.clone());
        all.push(match term {
            Friction::Viscous => optional(&joint.viscous, &joint.name)?,
            Friction::Coulomb => optional(&joint.coulomb, &joint.name)?,
            Friction::Offset => optional(&joint.offset, &joint.name)?,
            Friction::Cubic => optional(&joint.cubic, &joint.name)?,
            Friction::Stribeck => optional(&stribeck, &joint.name)?,
            Friction::Load => {
                let load = joint.load.as_ref().map_or(Some(Rational::ZERO), |load| load.as_rational().cloned());
                load.ok_or_else(|| format!("numbers of joint `{}` are not rational", joint.name))?
            }
        });
    }
    Ok(all)
}

/// The pivots of LDL' of the pseudo-inertia of each link's own body about its centre of mass, mass first, exactly; as text.
fn bodies(manipulator: &Manipulator) -> Result<Vec<Value>, String> {
    let of_joint = |joint: &armgen_codegen::manipulator::Joint| {
        let refused = || format!("the body of joint `{}` is not positive definite", joint.name);
        let body = &joint.link.first().ok_or_else(refused)?.given;
        let pivots = pivots_of(manipulator, body).ok_or_else(refused)?;
        Ok(json!({"joint": joint.name, "pivots": pivots}))
    };
    manipulator.joints.iter().map(of_joint).collect()
}

/// The pivots as fractions, or as the nearest floats where they are none.
fn pivots_of(manipulator: &Manipulator, body: &Body) -> Option<Vec<String>> {
    let minors = crate::written::minors(manipulator, body)?;
    let mut texts = Vec::new();
    for (k, minor) in minors.iter().enumerate() {
        let before = if k < 2 { Some(&Rational::ONE) } else { minors[k - 1].as_rational() };
        texts.push(match (minor.as_rational(), before) {
            (Some(minor), Some(before)) => (minor / before).to_string(),
            _ => format!("{:?}", minor.to_f64() / if k < 2 { 1.0 } else { minors[k - 1].to_f64() }),
        });
    }
    Some(texts)
}

fn hex(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn line(numbers: &[f64]) -> String {
    numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(" ")
}

fn numbers(value: &Value) -> Result<Vec<f64>, String> {
    let text = value.as_str().ok_or("a line of numbers is missing")?;
    text.split_whitespace().map(|word| word.parse().map_err(|_| format!("`{word}` is no number"))).collect()
}

fn lines(value: &Value) -> Result<Vec<Vec<f64>>, String> {
    value.as_array().ok_or("a list of lines is missing")?.iter().map(numbers).collect()
}

impl Stored {
    fn to_json(&self, arm: &Arm, gap: f64) -> Value {
        let name = |(joint, term): &(usize, Friction)| format!("{} {}", term.key(), arm.joints[*joint].name);
        json!({
            "gap": format!("{gap:?}"),
            "weight": format!("{:?}", self.mu),
            "least": format!("{:?}", self.least),
            "friction": self.friction.iter().map(name).collect::<Vec<_>>(),
            "references": self.references.iter().map(|ten| line(ten)).collect::<Vec<_>>(),
            "rotors": line(&self.rotors),
            "u": self.u.iter().map(|row| line(row)).collect::<Vec<_>>(),
            "c": line(&self.c),
            "point": self.point.iter().map(|pair| line(pair)).collect::<Vec<_>>(),
        })
    }

    fn from_json(value: &Value, arm: &Arm) -> Result<Stored, String> {
        let one = |key: &str| numbers(&value[key])?.first().copied().ok_or_else(|| format!("`{key}` is empty"));
        let mut friction = Vec::new();
        for name in value["friction"].as_array().ok_or("`friction` is no list")? {
            let (key, joint) = name.as_str().and_then(|name| name.split_once(' ')).unwrap_or_default();
            let joint = arm.joints.iter().position(|known| known.name == joint);
            let term = Friction::ALL.into_iter().find(|term| term.key() == key);
            friction.push(joint.zip(term).ok_or_else(|| format!("{name} is no friction of the description"))?);
        }
        let point = lines(&value["point"])?;
        Ok(Stored {
            friction,
            references: lines(&value["references"])?,
            rotors: numbers(&value["rotors"])?,
            u: lines(&value["u"])?,
            c: numbers(&value["c"])?,
            least: one("least")?,
            mu: one("weight")?,
            point: point.iter().map(|pair| [pair.first().copied().unwrap_or(0.0), pair.get(1).copied().unwrap_or(0.0)]).collect(),
        })
    }
}

/// phi of a problem: U is the root of H, upper triangular.
fn stored(arm: &Arm, reduced: &Reduced, of: &Consistent) -> Stored {
    let problem = problem(arm, reduced);
    let h = &reduced.gram.h;
    let n = h.nrows();
    let scale = DVector::from_fn(n, |i, _| h[(i, i)].max(0.0).sqrt());
    let over = |x: f64| if x > 0.0 { 1.0 / x } else { 0.0 };
    let eigen = SymmetricEigen::new(DMatrix::from_fn(n, n, |i, j| h[(i, j)] * over(scale[i]) * over(scale[j])));
    let root = DMatrix::from_fn(n, n, |i, j| eigen.eigenvalues[i].max(0.0).sqrt() * eigen.eigenvectors[(j, i)] * scale[j]);
    let u = root.qr().r();
    let c = &u * problem.least();
    let x: Vec<f64> = of.bodies.iter().flatten().chain(&of.rotors).chain(&of.friction).copied().collect();
    Stored {
        friction: reduced.friction.clone(),
        references: references(arm).iter().map(|ten| ten.to_vec()).collect(),
        rotors: arm.rotors.iter().map(|&joint| arm.joints[joint].rotor.max(0.0)).collect(),
        u: (0..n).map(|i| (i..n).map(|j| u[(i, j)]).collect()).collect(),
        c: c.as_slice().to_vec(),
        least: problem.unconstrained(),
        mu: of.mu,
        point: x.iter().map(|x| [*x, 0.0]).collect(),
    }
}

/// Newton's steps with exact gradients and a Hessian in floats, until the point proves a gap.
fn polish(stored: &mut Stored, arm: &Arm, problem: &Problem, nu: f64) -> Result<(), String> {
    let data = stored.data(arm)?;
    let weight = fractions(&[nu])?.remove(0);
    for _ in 0..8 {
        let x = stored.point()?;
        let dual = data.dual(&x)?;
        if data.gap(&dual, &dual.x).is_ok() {
            return Ok(());
        }
        // grad of phi with the barrier: S - nu J^-1 over the units of bodies, s - nu/x.
        let mut gradient = DVector::zeros(x.len());
        for (link, (s, inverse)) in dual.links.iter().enumerate() {
            let rest = combined(s, &-weight.clone(), inverse);
            for k in 0..10 {
                let unit: Vec<Rational> = (0..10).map(|i| if i == k { one() } else { Rational::ZERO }).collect();
                gradient[10 * link + k] = crate::exact::float(&trace_of_product(&rest, &pseudo_inertia(&unit)));
            }
        }
        for (place, s) in data.bounded.iter().zip(&dual.bounded) {
            gradient[*place] = crate::exact::float(&(s - &weight / &x[*place]));
        }
        let floats = DVector::from_iterator(x.len(), dual.x.iter().map(crate::exact::float));
        let hessian = problem.hessian(&floats, stored.mu, nu).ok_or("the point left what is possible")?;
        let scale = DVector::from_fn(x.len(), |i, _| 1.0 / hessian[(i, i)].max(1e-300).sqrt());
        let mut scaled = DMatrix::from_fn(x.len(), x.len(), |i, j| hessian[(i, j)] * scale[i] * scale[j]);
        (0..x.len()).for_each(|i| scaled[(i, i)] += 1e-14);
        let factor = scaled.cholesky().ok_or("the Hessian is not positive definite")?;
        let step = -factor.solve(&gradient.component_mul(&scale)).component_mul(&scale);
        for (k, pair) in stored.point.iter_mut().enumerate() {
            let exact = &dual.x[k] + fractions(&[step[k]])?.remove(0);
            let high = crate::exact::float(&exact);
            let low = crate::exact::float(&(exact - fractions(&[high])?.remove(0)));
            *pair = [high, low];
        }
    }
    Err("no point near the numbers proves that they are optimal".to_owned())
}

/// The certificate of a written description, and what it proves.
///
/// # Errors
///
/// The reason why the text has a body that is not possible, or is no description.
pub fn certificate(
    source: &Source,
    link_side: bool,
    arm: &Arm,
    reduced: &Reduced,
    of: &Consistent,
) -> Result<(String, Proved), String> {
    let manipulator = read(source)?;
    let bodies = bodies(&manipulator)?;
    let mut stored = stored(arm, reduced, of);
    let gap = written_of(&manipulator, arm, &stored.friction).and_then(|written| {
        polish(&mut stored, arm, &problem(arm, reduced), of.nu)?;
        stored.gap(arm, &written)
    });
    let proved = Proved { bodies: bodies.len(), gap: gap.clone() };
    let mut all = json!({
        "certificate": FORMAT,
        "robot": manipulator.name,
        "torque": if link_side { "link" } else { "motor" },
        "description": hex(source.text()),
        "bodies": bodies,
        "optimality": match &gap {
            Ok(gap) => stored.to_json(arm, *gap),
            Err(reason) => json!({"not_proved": reason}),
        },
    });
    all["sha256"] = json!(hex(&all.to_string()));
    let text = serde_json::to_string_pretty(&all).expect("strings always have a JSON form") + "\n";
    Ok((text, proved))
}

/// A description with identified numbers, with as many digits as optimality within [`LARGEST_GAP`] takes, if any do; and its certificate.
///
/// # Errors
///
/// The reason why the text cannot have the numbers.
pub fn write_certified(
    source: &Source,
    link_side: bool,
    arm: &Arm,
    found: &Identified,
    of: &Consistent,
) -> Result<(Written, String, Proved), String> {
    let with = |finer: usize| {
        let written = write_finer(source, arm, found, of, finer)?;
        let text = Source::new(source.name(), written.text.as_str());
        let (certificate, proved) = certificate(&text, link_side, arm, &found.reduced, of)?;
        Ok::<_, String>((written, certificate, proved))
    };
    let first = with(0)?;
    if first.2.gap.as_ref().is_ok_and(|gap| *gap > LARGEST_GAP) {
        for finer in 1..=3 {
            let next = with(finer)?;
            if next.2.gap.as_ref().is_ok_and(|gap| *gap <= LARGEST_GAP) {
                return Ok(next);
            }
        }
    }
    Ok(first)
}

fn read(source: &Source) -> Result<Manipulator, String> {
    let (read, diagnostics) = validate::read(source);
    let valid = read.filter(|_| !diagnostics.has_errors()).ok_or("the description is faulty: `armgen check` lists its faults")?;
    Ok(valid.0)
}

/// Whether a text is such a certificate.
pub fn is_one(text: &str) -> bool {
    text.trim_start().starts_with('{') && text.contains(FORMAT)
}

/// Checks a certificate against the description that it is of, from these two texts alone.
///
/// # Errors
///
/// What is wrong with it.
pub fn check(source: &Source, text: &str) -> Result<Proved, String> {
    let mut all: Value = serde_json::from_str(text).map_err(|error| format!("no JSON: {error}"))?;
    let stated = all.as_object_mut().and_then(|all| all.remove("sha256")).unwrap_or_default();
    if all["certificate"] != FORMAT {
        return Err(format!("`certificate` is not \"{FORMAT}\""));
    }
    if stated != hex(&all.to_string()) {
        return Err("its text changed after it was written: `sha256` is of another".to_owned());
    }
    if all["description"] != hex(source.text()) {
        return Err(format!("it is of another description: {} changed, or never had this certificate", source.name()));
    }
    let manipulator = read(source)?;
    let bodies = bodies(&manipulator)?;
    if all["bodies"] != json!(bodies) {
        return Err("its pivots are not those of the description".to_owned());
    }
    let link_side = all["torque"] == "link";
    let optimality = &all["optimality"];
    let gap = match optimality.get("not_proved").and_then(Value::as_str) {
        Some(reason) => Err(reason.to_owned()),
        None => {
            let arm = Arm::new(&manipulator, link_side).ok_or("nothing of the arm has mass")?;
            let stored = Stored::from_json(optimality, &arm)?;
            let written = written_of(&manipulator, &arm, &stored.friction)?;
            let gap = stored.gap(&arm, &written)?;
            if optimality["gap"] != format!("{gap:?}") {
                return Err(format!("its gap is {}, and {gap:?} is proved", optimality["gap"]));
            }
            Ok(gap)
        }
    };
    Ok(Proved { bodies: bodies.len(), gap })
}
