//! A program over another arithmetic than floats: what a checker reads is what is executed.

use crate::function::{Angle, Input, Operator};
use crate::program::{Code, Form, Load, Program, Wave};
use crate::scalar::Scalar;

/// An arithmetic that a program can be executed over.
pub trait Arithmetic<T> {
    /// Its numbers.
    type Value: Clone;

    /// An entry of an argument, its sign, or its fading; the kinds of sines and cosines are not asked for.
    fn input(&mut self, input: &Input<T>) -> Self::Value;

    /// The sine and the cosine of an angle.
    fn sine_cosine(&mut self, angle: &Angle<T>) -> (Self::Value, Self::Value);

    /// A constant.
    fn constant(&mut self, value: T) -> Self::Value;

    /// The result of an operation; a sign is that of the left operand, which is given twice.
    fn result(&mut self, operator: Operator, left: &Self::Value, right: &Self::Value) -> Self::Value;

    /// The opposite number.
    fn negated(&mut self, value: &Self::Value) -> Self::Value;
}

impl<T: Scalar> Program<T> {
    /// The result of one state over an arithmetic, with the instructions and the places of [`Program::run`], in its order. A product that was joined with
    /// a sum is a product and a sum here: both round.
    ///
    /// None: an instruction reads a place before something is written there. No program that [`Program::new`] makes does so.
    pub fn over<A: Arithmetic<T>>(&self, with: &mut A) -> Option<Vec<A::Value>> {
        let mut places: Vec<Option<A::Value>> = vec![None; self.places];
        for Wave { angle, sine, cosine } in &self.waves {
            let (of_sine, of_cosine) = with.sine_cosine(angle);
            for (place, value) in [(sine, of_sine), (cosine, of_cosine)] {
                if let Some(place) = place {
                    *places.get_mut(*place as usize)? = Some(value);
                }
            }
        }
        for &Load { argument, entry, form, place } in &self.loads {
            let input = match form {
                Form::Itself => Input::Entry { argument, entry },
                Form::Sign => Input::Sign { argument, entry },
                Form::Fading(velocity) => Input::Fading { argument, entry, velocity },
            };
            *places.get_mut(place as usize)? = Some(with.input(&input));
        }
        for of in &self.instructions {
            let value = |place: u32| places.get(place as usize).cloned().flatten();
            let (a, b, c) = (value(of.a), value(of.b), value(of.c));
            let mut both = |operator, left, right| Some(with.result(operator, &left?, &right?));
            let result = match of.code {
                Code::Add => both(Operator::Add, a, b),
                Code::Subtract => both(Operator::Subtract, a, b),
                Code::Multiply => both(Operator::Multiply, a, b),
                Code::Divide => both(Operator::Divide, a, b),
                Code::Sign => both(Operator::Sign, a.clone(), a),
                Code::OppositeSign => both(Operator::OppositeSign, a.clone(), a),
                Code::MultiplyAdd => {
                    let product = both(Operator::Multiply, a, b);
                    both(Operator::Add, product, c)
                }
                Code::MultiplySubtract => {
                    let product = both(Operator::Multiply, a, b);
                    both(Operator::Subtract, product, c)
                }
                Code::SubtractProduct => {
                    let product = both(Operator::Multiply, a, b);
                    both(Operator::Subtract, c, product)
                }
                of_constant => {
                    let k = Some(with.constant(of.k));
                    let mut both = |operator, left, right| Some(with.result(operator, &left?, &right?));
                    match of_constant {
                        Code::AddConstant => both(Operator::Add, a, k),
                        Code::SubtractConstant => both(Operator::Subtract, a, k),
                        Code::SubtractFromConstant => both(Operator::Subtract, k, a),
                        Code::MultiplyConstant => both(Operator::Multiply, a, k),
                        Code::DivideByConstant => both(Operator::Divide, a, k),
                        Code::DivideConstant => both(Operator::Divide, k, a),
                        Code::MultiplyConstantAdd => {
                            let product = both(Operator::Multiply, a, k);
                            both(Operator::Add, product, c)
                        }
                        Code::MultiplyConstantSubtract => {
                            let product = both(Operator::Multiply, a, k);
                            both(Operator::Subtract, product, c)
                        }
                        Code::SubtractConstantProduct => {
                            let product = both(Operator::Multiply, a, k);
                            both(Operator::Subtract, c, product)
                        }
                        _ => k,
                    }
                }
            };
            *places.get_mut(of.to as usize)? = Some(result?);
        }
        let outputs = self.stores.iter().map(|store| {
            let value = places.get(store.place as usize).cloned().flatten()?;
            Some(if store.negated { with.negated(&value) } else { value })
        });
        outputs.collect()
    }
}
