//! A state: the values of all inputs of the equations.

use super::angles::Angles;
use crate::values::arithmetic::dual::Dual;
use crate::values::arithmetic::Arithmetic;
use crate::values::element::Element;
use crate::values::float::Arguments;
use crate::values::program::{by_addition, Argument, Inputs, Scaled, Turn};

/// Values of joint variables, rates, accelerations, references, torques and parameters.
#[derive(Clone, Debug)]
pub struct State<E> {
    /// Sine and cosine of each joint variable, then of each computed angle. Those of prismatic joints occur in no equation; no function may use them
    /// alone.
    pub angles: Vec<(E, E)>,
    /// Of each computed angle its coordinates with their factors.
    pub computed: Vec<Vec<(usize, E)>>,
    /// Joint variables. Revolute ones enter the equations only through sine and cosine, and through the torques of springs.
    pub q: Vec<E>,
    /// Joint rates.
    pub dq: Vec<E>,
    /// Joint accelerations.
    pub ddq: Vec<E>,
    /// Reference rates.
    pub dqr: Vec<E>,
    /// Reference accelerations.
    pub ddqr: Vec<E>,
    /// Joint torques.
    pub tau: Vec<E>,
    /// Signs of the joint rates, as independent inputs.
    pub signs: Vec<E>,
    /// What Coulomb friction is multiplied with: the signs, or tanh(dq / 2 v).
    pub directions: Vec<E>,
    /// Whether they are tanh(dq / 2 v).
    pub smooth: Vec<bool>,
    /// exp(-|dq| / v) of the joints whose friction has them, as independent inputs.
    pub stribeck: Vec<E>,
    /// Their velocities v, for derivatives by the rates; 1 until an arm sets them.
    pub stribeck_velocities: Vec<E>,
    /// The parameter vector.
    pub pi: Vec<E>,
    /// Acceleration of free fall; empty where that is no argument.
    pub g0: Vec<E>,
    /// 0.
    pub zero: E,
    /// 1.
    pub one: E,
}

impl<E: Element> State<E> {
    /// A state with these arguments, without Stribeck friction.
    pub fn of(arguments: Arguments<E>, angles: Vec<(E, E)>, signs: Vec<E>, [zero, one]: [E; 2]) -> State<E> {
        let Arguments { pi, q, dq, ddq, dqr, ddqr, tau, g0 } = arguments;
        let (stribeck, stribeck_velocities) = (vec![zero.clone(); q.len()], vec![one.clone(); q.len()]);
        let (directions, smooth) = (signs.clone(), vec![false; signs.len()]);
        let computed = Vec::new();
        State {
            angles,
            computed,
            q,
            dq,
            ddq,
            dqr,
            ddqr,
            tau,
            signs,
            directions,
            smooth,
            stribeck,
            stribeck_velocities,
            pi,
            g0,
            zero,
            one,
        }
    }

    /// The same with random exponentials for joints whose friction has them.
    #[must_use]
    pub fn with_decays<K: Arithmetic<Element = E>>(
        mut self,
        arithmetic: &mut K,
        joints: impl IntoIterator<Item = bool>,
    ) -> State<E> {
        for (value, _) in self.stribeck.iter_mut().zip(joints).filter(|(_, has_it)| *has_it) {
            *value = arithmetic.draw();
        }
        self
    }

    /// The same with a random acceleration of free fall, where that is an argument.
    #[must_use]
    pub fn with_gravity<K: Arithmetic<Element = E>>(mut self, arithmetic: &mut K, is_argument: bool) -> State<E> {
        if is_argument {
            self.g0 = (0..3).map(|_| arithmetic.draw()).collect();
        }
        self
    }

    /// A random state without Stribeck friction; the caller fills in `pi`.
    pub fn draw<K: Arithmetic<Element = E>>(arithmetic: &mut K, angles: &Angles) -> State<E> {
        let n = angles.coordinates();
        let mut many = |_| (0..n).map(|_| arithmetic.draw()).collect::<Vec<E>>();
        let [q, dq, ddq, dqr, ddqr, tau, signs] = [0; 7].map(&mut many);
        // A factor without a value refuses the arm elsewhere.
        let computed = angles.factors(arithmetic).unwrap_or_default();
        let angles = angles.draw(arithmetic);
        let (zero, one) = (arithmetic.integer(0), arithmetic.integer(1));
        let [pi, g0] = [Vec::new(), Vec::new()];
        State { computed, ..State::of(Arguments { pi, q, dq, ddq, dqr, ddqr, tau, g0 }, angles, signs, [zero, one]) }
    }

    /// The state as dual numbers: joint variables change with `along`, rates with `rates`, everything else is constant.
    pub fn moving(&self, along: &[E], rates: &[E]) -> State<Dual<E>> {
        let still = |v: &[E]| v.iter().map(Dual::constant).collect::<Vec<_>>();
        let with = |v: &[E], rates: &[E]| {
            v.iter().zip(rates).map(|(value, rate)| Dual { value: value.clone(), rate: rate.clone() }).collect::<Vec<_>>()
        };
        let of_sum = |factors: &Vec<(usize, E)>| {
            factors.iter().fold(self.zero.clone(), |sum, (a, factor)| sum.plus(&factor.times(&along[*a])))
        };
        let own = along.iter().cloned().chain(self.computed.iter().map(of_sum));
        let angles = self.angles.iter().zip(own).map(|((s, c), rate)| {
            let sine = Dual { value: s.clone(), rate: c.times(&rate) };
            (sine, Dual { value: c.clone(), rate: s.times(&rate).negated() })
        });
        let still_factors = |factors: &Vec<(usize, E)>| factors.iter().map(|(a, factor)| (*a, Dual::constant(factor))).collect();
        // d/dt exp(-|dq| / v) = -sign(dq) ddq exp(-|dq| / v) / v
        let fading = |(i, value): (usize, &E)| {
            let by_rate = self.signs[i].times(value).over(&self.stribeck_velocities[i]).unwrap_or_else(|| self.zero.clone());
            Dual { value: value.clone(), rate: by_rate.times(&rates[i]).negated() }
        };
        // d/dt tanh(dq / 2 v) = (1 - tanh²) ddq / 2 v
        let direction = |(i, value): (usize, &E)| {
            if !self.smooth[i] {
                return Dual::constant(value);
            }
            let (rest, velocity) = (self.one.minus(&value.times(value)), &self.stribeck_velocities[i]);
            let slope = rest.over(&velocity.plus(velocity)).unwrap_or_else(|| self.zero.clone());
            Dual { value: value.clone(), rate: slope.times(&rates[i]) }
        };
        State {
            stribeck: self.stribeck.iter().enumerate().map(fading).collect(),
            stribeck_velocities: still(&self.stribeck_velocities),
            angles: angles.collect(),
            computed: self.computed.iter().map(still_factors).collect(),
            q: with(&self.q, along),
            dq: with(&self.dq, rates),
            ddq: still(&self.ddq),
            dqr: still(&self.dqr),
            ddqr: still(&self.ddqr),
            tau: still(&self.tau),
            signs: still(&self.signs),
            directions: self.directions.iter().enumerate().map(direction).collect(),
            smooth: self.smooth.clone(),
            pi: still(&self.pi),
            g0: still(&self.g0),
            zero: Dual::constant(&self.zero),
            one: Dual::constant(&self.one),
        }
    }
}

impl<E> State<E> {
    /// The same state in another number type.
    pub fn map<F>(self, of: &dyn Fn(E) -> F) -> State<F> {
        let all = |values: Vec<E>| values.into_iter().map(of).collect::<Vec<F>>();
        State {
            angles: self.angles.into_iter().map(|(sine, cosine)| (of(sine), of(cosine))).collect(),
            computed: (self.computed.into_iter())
                .map(|factors| factors.into_iter().map(|(a, factor)| (a, of(factor))).collect())
                .collect(),
            q: all(self.q),
            dq: all(self.dq),
            ddq: all(self.ddq),
            dqr: all(self.dqr),
            ddqr: all(self.ddqr),
            tau: all(self.tau),
            signs: all(self.signs),
            directions: all(self.directions),
            smooth: self.smooth,
            stribeck: all(self.stribeck),
            stribeck_velocities: all(self.stribeck_velocities),
            pi: all(self.pi),
            g0: all(self.g0),
            zero: of(self.zero),
            one: of(self.one),
        }
    }
}

impl<E: Element> Inputs<E> for State<E> {
    fn entry(&self, argument: Argument, index: usize) -> E {
        let values = match argument {
            Argument::Pi => &self.pi,
            Argument::Q => &self.q,
            Argument::Dq => &self.dq,
            Argument::Ddq => &self.ddq,
            Argument::Dqr => &self.dqr,
            Argument::Ddqr => &self.ddqr,
            Argument::Tau => &self.tau,
            Argument::Gravity => &self.g0,
        };
        values[index].clone()
    }

    fn sine_cosine(&self, angle: &[(usize, i64)]) -> (E, E) {
        let mut sum = (self.zero.clone(), self.one.clone());
        for &(joint, factor) in angle {
            let (s, c) = &self.angles[joint];
            let s = if factor < 0 { s.negated() } else { s.clone() };
            for _ in 0..factor.unsigned_abs() {
                // sin(a + b), cos(a + b)
                sum = (sum.0.times(c).plus(&sum.1.times(&s)), sum.1.times(c).minus(&sum.0.times(&s)));
            }
        }
        sum
    }

    fn sign(&self, joint: usize) -> E {
        self.signs[joint].clone()
    }

    /// The literal is the joint's Stribeck velocity; a check before any run ensures this.
    fn stribeck(&self, joint: usize, _: &E) -> E {
        self.stribeck[joint].clone()
    }

    fn turned(&self, angle: &[(usize, i64)], turn: &Turn<'_, E>) -> (E, E) {
        by_addition(self.sine_cosine(angle), turn)
    }

    /// Of no joint variable of the description: no function has it ([`Angles::name`]). A point off the circle equals nothing.
    fn scaled(&self, _: &[Scaled<E>], _: Option<E>) -> (E, E) {
        (self.zero.clone(), self.zero.clone())
    }

    fn computed(&self, angle: usize) -> Option<(E, E)> {
        self.angles.get(self.q.len() + angle).cloned()
    }
}
