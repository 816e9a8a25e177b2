// States side by side, one in each lane, by the same functions as in the companion: taken into the module of each scalar, where `Real`, `Bounded`
// and its operations stand. Bound for bound the bits are those of `bounds`.

/// Values of a step in all lanes, each with how far it can be from the exact one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Many {
    value: [Real; LANES],
    error: [Real; LANES],
}

impl Many {
    const NOTHING: Many = Many { value: [0.0; LANES], error: [0.0; LANES] };

    #[inline(always)]
    fn at(&self, lane: usize) -> Bounded {
        Bounded { value: self.value[lane], error: self.error[lane] }
    }

    #[inline(always)]
    fn of(at: impl Fn(usize) -> Bounded) -> Many {
        let mut many = Many::NOTHING;
        for lane in 0..LANES {
            let one = at(lane);
            (many.value[lane], many.error[lane]) = (one.value, one.error);
        }
        many
    }
}

/// Arguments in lanes.
#[derive(Debug)]
pub(super) struct Side {
    arguments: Arguments<[Real; LANES]>,
}

impl Side {
    pub(super) fn new(states: &[Arguments<f64>; LANES]) -> Side {
        Side { arguments: Arguments::gather(states, |states| states.map(|x| x as Real)) }
    }
}

/// A function made ready to run in lanes.
#[derive(Clone, Debug)]
pub(super) struct Lanes {
    steps: Vec<Step>,
    inputs: Vec<Option<crate::values::program::Argument>>,
    angles: Vec<(Vec<(u32, Real)>, super::Sum)>,
    values: Vec<Many>,
    roundings: Vec<[Real; LANES]>,
    sensitivities: Vec<Many>,
    /// The entries that are bounded by sensitivities, each with the steps that it stands on, last first, once it was asked for.
    cones: std::collections::BTreeMap<u32, Option<Vec<u32>>>,
}

impl Lanes {
    pub(super) fn new(rows: &[super::Row], angles: &[super::Sum], entries: &[u32], sensitive: bool) -> Lanes {
        let steps: Vec<Step> = rows.iter().map(step).collect();
        let input = |row: &super::Row| match row {
            super::Row::In(argument, _) => Some(*argument),
            _ => None,
        };
        let many = || vec![Many::NOTHING; steps.len()];
        Lanes {
            inputs: rows.iter().map(input).collect(),
            angles: angles.iter().map(|sum| (terms(sum), sum.clone())).collect(),
            values: many(),
            roundings: vec![[0.0; LANES]; steps.len()],
            sensitivities: many(),
            cones: entries.iter().filter(|_| sensitive).map(|&entry| (entry, None)).collect(),
            steps,
        }
    }

    /// Runs through all steps.
    pub(super) fn forward(&mut self, side: &Side) {
        for (i, step) in self.steps.iter().enumerate() {
            let values = &self.values;
            let both = |a: u32, b: u32| (&values[a as usize], &values[b as usize]);
            let many = match *step {
                Step::In(_, index) => {
                    let argument = self.inputs[i].map_or(&[][..], |argument| side.arguments.of(argument));
                    Many { value: argument[index as usize], error: [0.0; LANES] }
                }
                Step::Lit(value, error) => Many { value: [value; LANES], error: [error; LANES] },
                Step::Sin(index) | Step::Cos(index) => {
                    let (terms, sum) = &self.angles[index as usize];
                    let sum = angle_of(terms, sum);
                    Many::of(|lane| {
                        let angle = angle(&sum, |joint| side.arguments.q[joint][lane]);
                        let (sine, cosine) = sin_cos(angle.value);
                        wave(if matches!(step, Step::Sin(_)) { sine } else { cosine }, angle.error)
                    })
                }
                Step::Sign(joint) => Many::of(|lane| sign(side.arguments.dq[joint as usize][lane])),
                Step::Stribeck(joint, velocity) => Many::of(|lane| fading(side.arguments.dq[joint as usize][lane], velocity)),
                Step::SignOf(a) => Many::of(|lane| sign_of(values[a as usize].at(lane))),
                Step::Neg(a) => Many::of(|lane| negated(values[a as usize].at(lane))),
                Step::Add(a, b) => {
                    let (a, b) = both(a, b);
                    Many::of(|lane| plus(a.at(lane), b.at(lane)))
                }
                Step::Sub(a, b) => {
                    let (a, b) = both(a, b);
                    Many::of(|lane| plus(a.at(lane), negated(b.at(lane))))
                }
                Step::Mul(a, b) => {
                    let (a, b) = both(a, b);
                    Many::of(|lane| times(a.at(lane), b.at(lane)))
                }
                Step::Scale(a, b) => {
                    let (a, b) = both(a, b);
                    Many::of(|lane| scaled(a.at(lane), b.at(lane)))
                }
                Step::Fma(a, b, c) => {
                    let ((a, b), c) = (both(a, b), &values[c as usize]);
                    Many::of(|lane| fused(a.at(lane), b.at(lane), c.at(lane)))
                }
                Step::Div(a, b) => {
                    let (a, b) = both(a, b);
                    Many::of(|lane| over(a.at(lane), b.at(lane)))
                }
            };
            self.values[i] = many;
            for lane in 0..LANES {
                self.roundings[i][lane] = rounding(step, &many.at(lane));
            }
        }
    }

    /// Value of a step, and its running error.
    #[allow(clippy::useless_conversion)]
    pub(super) fn step(&self, step: usize) -> ([f64; LANES], [f64; LANES]) {
        let many = &self.values[step];
        (many.value.map(f64::from), many.error.map(f64::from))
    }

    /// The running bounds of a step, whatever bounds the companion has.
    #[allow(clippy::useless_conversion)]
    pub(super) fn running(&self, step: usize) -> [f64; LANES] {
        self.values[step].error.map(|running| f64::from(finished(running, self.steps.len())))
    }

    /// The bounds of a step that is an entry.
    #[allow(clippy::useless_conversion)]
    pub(super) fn bound(&mut self, entry: u32) -> [f64; LANES] {
        let Some(cone) = self.cones.get_mut(&entry) else { return self.running(entry as usize) };
        let cone = cone.get_or_insert_with(|| cone_of(&self.steps, entry));
        let bound = backward_in_lanes(&self.steps, &self.values, &self.roundings, &mut self.sensitivities, cone);
        bound.map(|bound| f64::from(finished(bound, self.steps.len())))
    }
}

/// The steps that an entry stands on, last first, itself the first one.
fn cone_of(steps: &[Step], entry: u32) -> Vec<u32> {
    let mut inside = vec![false; entry as usize + 1];
    inside[entry as usize] = true;
    for i in (0..=entry as usize).rev() {
        if !inside[i] {
            continue;
        }
        match steps[i] {
            Step::In(..) | Step::Lit(..) | Step::Sin(_) | Step::Cos(_) | Step::Sign(_) | Step::Stribeck(..) => {}
            // As an input, off by what its rounding is.
            Step::SignOf(_) => {}
            Step::Neg(a) => inside[a as usize] = true,
            Step::Add(a, b) | Step::Sub(a, b) | Step::Mul(a, b) | Step::Scale(a, b) | Step::Div(a, b) => {
                inside[a as usize] = true;
                inside[b as usize] = true;
            }
            Step::Fma(a, b, c) => [a, b, c].iter().for_each(|&k| inside[k as usize] = true),
        }
    }
    (0..=entry).rev().filter(|&i| inside[i as usize]).collect()
}

/// [`backward`] in lanes; what it leaves in `sensitivities` is 0 again.
fn backward_in_lanes(
    steps: &[Step],
    values: &[Many],
    roundings: &[[Real; LANES]],
    sensitivities: &mut [Many],
    cone: &[u32],
) -> [Real; LANES] {
    sensitivities[cone[0] as usize].value = [1.0; LANES];
    let mut bound = [0.0; LANES];
    for &i in cone {
        let i = i as usize;
        let own = std::mem::replace(&mut sensitivities[i], Many::NOTHING);
        let mut active = [false; LANES];
        for lane in 0..LANES {
            active[lane] = own.value[lane] != 0.0 || own.error[lane] != 0.0;
            let more = bound[lane] + (own.value[lane].abs() + own.error[lane]) * roundings[i][lane];
            bound[lane] = if active[lane] { more } else { bound[lane] };
        }
        match steps[i] {
            Step::In(..) | Step::Lit(..) | Step::Sin(_) | Step::Cos(_) | Step::Sign(_) | Step::Stribeck(..) => {}
            Step::SignOf(_) => {}
            Step::Neg(a) => add(&mut sensitivities[a as usize], &active, |lane| negated(own.at(lane))),
            Step::Add(a, b) => {
                add(&mut sensitivities[a as usize], &active, |lane| own.at(lane));
                add(&mut sensitivities[b as usize], &active, |lane| own.at(lane));
            }
            Step::Sub(a, b) => {
                add(&mut sensitivities[a as usize], &active, |lane| own.at(lane));
                add(&mut sensitivities[b as usize], &active, |lane| negated(own.at(lane)));
            }
            Step::Mul(a, b) | Step::Scale(a, b) => {
                let (x, y) = (&values[a as usize], &values[b as usize]);
                add(&mut sensitivities[a as usize], &active, |lane| times(own.at(lane), y.at(lane)));
                add(&mut sensitivities[b as usize], &active, |lane| times(own.at(lane), x.at(lane)));
            }
            Step::Fma(a, b, c) => {
                let (x, y) = (&values[a as usize], &values[b as usize]);
                add(&mut sensitivities[a as usize], &active, |lane| times(own.at(lane), y.at(lane)));
                add(&mut sensitivities[b as usize], &active, |lane| times(own.at(lane), x.at(lane)));
                add(&mut sensitivities[c as usize], &active, |lane| own.at(lane));
            }
            Step::Div(a, b) => {
                let (divisor, quotient) = (&values[b as usize], &values[i]);
                let part = Many::of(|lane| over(own.at(lane), divisor.at(lane)));
                add(&mut sensitivities[a as usize], &active, |lane| part.at(lane));
                add(&mut sensitivities[b as usize], &active, |lane| negated(times(part.at(lane), quotient.at(lane))));
            }
        }
    }
    bound
}

#[inline(always)]
fn add(to: &mut Many, active: &[bool; LANES], part: impl Fn(usize) -> Bounded) {
    for lane in 0..LANES {
        let (old, part) = (to.at(lane), part(lane));
        let sum = plus(old, part);
        let first = old.value == 0.0 && old.error == 0.0;
        let (value, error) = if first { (part.value, part.error) } else { (sum.value, sum.error) };
        to.value[lane] = if active[lane] { value } else { old.value };
        to.error[lane] = if active[lane] { error } else { old.error };
    }
}
