//! Random functions against a plain evaluation, operation by operation.

use super::*;

#[cfg(target_arch = "x86_64")]
#[path = "../../tests/src/installed.rs"]
mod installed;

/// A generator of random numbers (SplitMix64: Steele, Lea, Flood, 2014).
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, bound: usize) -> usize {
        (self.next() % bound as u64) as usize
    }

    /// Mostly ordinary numbers, sometimes special ones.
    fn number(&mut self) -> f64 {
        const SPECIAL: [f64; 9] = [0.0, -0.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN, 1e300, -1e-310, 65537.0, -1e9];
        match self.below(12) {
            0 => SPECIAL[self.below(SPECIAL.len())],
            _ => (self.next() >> 11) as f64 / (1u64 << 50) as f64 - 4.0,
        }
    }
}

const LENGTHS: [usize; 2] = [3, 2];

fn random_function(random: &mut Random) -> Function<f64> {
    let argument = |(name, length): (&str, usize)| Argument { name: name.into(), length };
    let angles: Vec<Angle<f64>> = vec![
        Angle { argument: 0, terms: vec![(2, false)], factors: vec![], turn: None },
        Angle {
            argument: 0,
            terms: vec![(0, false), (1, true), (2, false)],
            factors: vec![None, Some(0.75), Some(1.25)],
            turn: Some(-0.5),
        },
    ];
    let inputs = vec![
        Input::Sine(0),
        Input::Cosine(1),
        Input::Sine(1),
        Input::Entry { argument: 0, entry: 1 },
        Input::Entry { argument: 1, entry: 0 },
        Input::Sign { argument: 1, entry: 1 },
        Input::Fading { argument: 1, entry: 1, velocity: 0.25 },
    ];
    let count = 1 + random.below(60);
    let operand = |random: &mut Random, bound: usize| match random.below(5) {
        0 => Operand::Constant(random.number()),
        // Recent values, so that products and sums follow each other.
        1 | 2 => Operand::Value(bound - 1 - random.below(bound.min(4))),
        _ => Operand::Value(random.below(bound)),
    };
    let operations = (0..count).map(|i| {
        let operators = [
            Operator::Add,
            Operator::Subtract,
            Operator::Multiply,
            Operator::Multiply,
            Operator::Divide,
            Operator::Sign,
            Operator::OppositeSign,
        ];
        let operator = operators[random.below(operators.len())];
        Operation { operator, left: operand(random, inputs.len() + i), right: operand(random, inputs.len() + i) }
    });
    let operations: Vec<_> = operations.collect();
    let outputs: Vec<_> =
        (0..4).map(|_| Output { operand: operand(random, inputs.len() + count), negated: random.below(2) == 0 }).collect();
    let sines = [Sines::Libm, Sines::Std, Sines::Fast][random.below(3)];
    Function {
        name: "random".into(),
        arguments: ["q", "dq"].into_iter().zip(LENGTHS).map(argument).collect(),
        results: vec![Result { name: "a".into(), shape: vec![] }, Result { name: "b".into(), shape: vec![1, 3] }],
        sines,
        angles,
        inputs,
        operations,
        outputs,
    }
}

fn sign(x: f64) -> f64 {
    if x > 0.0 {
        1.0
    } else if x < 0.0 {
        -1.0
    } else {
        x
    }
}

fn sin_cos(angle: &Angle<f64>, sines: Sines, arguments: [&[f64]; 2]) -> (f64, f64) {
    let value = |k: usize| angle.factors.get(k).copied().flatten().unwrap_or(1.0) * arguments[angle.argument][angle.terms[k].0];
    let term = |sum: f64, k: usize| if angle.terms[k].1 { sum - value(k) } else { sum + value(k) };
    let sum = (1..angle.terms.len()).fold(value(0), term);
    let sum = angle.turn.map_or(sum, |turn| sum + turn);
    match sines {
        Sines::Libm => libm::sincos(sum),
        Sines::Std => sum.sin_cos(),
        Sines::Fast => armgen_elementary::f64::sin_cos_of_any(sum),
    }
}

fn operated(operator: Operator, a: f64, b: f64) -> f64 {
    match operator {
        Operator::Add => a + b,
        Operator::Subtract => a - b,
        Operator::Multiply => a * b,
        Operator::Divide => a / b,
        Operator::Sign => sign(a),
        Operator::OppositeSign => sign(-a),
    }
}

/// The result of one state, value by value.
fn plain(function: &Function<f64>, arguments: [&[f64]; 2]) -> Vec<f64> {
    let sin_cos = |angle: usize| sin_cos(&function.angles[angle], function.sines, arguments);
    let mut values: Vec<f64> = Vec::new();
    for input in &function.inputs {
        values.push(match *input {
            Input::Sine(angle) => sin_cos(angle).0,
            Input::Cosine(angle) => sin_cos(angle).1,
            Input::Entry { argument, entry } => arguments[argument][entry],
            Input::Sign { argument, entry } => sign(arguments[argument][entry]),
            Input::Fading { argument, entry, velocity } => armgen_elementary::f64::fading(arguments[argument][entry], velocity),
        });
    }
    let of = |values: &[f64], operand: Operand<f64>| match operand {
        Operand::Value(value) => values[value],
        Operand::Constant(k) => k,
    };
    for operation in &function.operations {
        let (a, b) = (of(&values, operation.left), of(&values, operation.right));
        values.push(operated(operation.operator, a, b));
    }
    let outputs = function.outputs.iter().map(|output| {
        let value = of(&values, output.operand);
        if output.negated {
            -value
        } else {
            value
        }
    });
    outputs.collect()
}

/// Floats as any other arithmetic.
struct Floats<'a> {
    arguments: [&'a [f64]; 2],
    sines: Sines,
}

impl Arithmetic<f64> for Floats<'_> {
    type Value = f64;

    fn input(&mut self, input: &Input<f64>) -> f64 {
        match *input {
            Input::Entry { argument, entry } => self.arguments[argument][entry],
            Input::Sign { argument, entry } => sign(self.arguments[argument][entry]),
            Input::Fading { argument, entry, velocity } => {
                armgen_elementary::f64::fading(self.arguments[argument][entry], velocity)
            }
            Input::Sine(_) | Input::Cosine(_) => panic!("angles are asked for by themselves"),
        }
    }

    fn sine_cosine(&mut self, angle: &Angle<f64>) -> (f64, f64) {
        sin_cos(angle, self.sines, self.arguments)
    }

    fn constant(&mut self, value: f64) -> f64 {
        value
    }

    fn result(&mut self, operator: Operator, a: &f64, b: &f64) -> f64 {
        operated(operator, *a, *b)
    }

    fn negated(&mut self, value: &f64) -> f64 {
        -value
    }
}

/// Bits; one pattern for all that is not a number.
fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|value| if value.is_nan() { u64::MAX } else { value.to_bits() }).collect()
}

#[test]
fn random_functions_have_the_bits_of_a_plain_evaluation_at_every_number_of_states_and_over_any_arithmetic() {
    const SEED: u64 = 20;
    for seed in SEED..SEED + 150 {
        let mut random = Random(seed);
        let function = random_function(&mut random);
        let program = Program::new(&function).expect("a valid function");
        let mut workspace = program.workspace();
        for states in [1, 2, 7, 16, 17, 64, 65, 83] {
            let given = LENGTHS.map(|length| (0..states * length).map(|_| random.number()).collect::<Vec<_>>());
            let mut result = vec![7.0; states * 4];
            program.run(&[&given[0], &given[1]], &mut result, &mut workspace).expect("lengths that fit");
            for state in 0..states {
                let own = [0, 1].map(|i| &given[i][state * LENGTHS[i]..(state + 1) * LENGTHS[i]]);
                let found = &result[state * 4..(state + 1) * 4];
                assert_eq!(bits(found), bits(&plain(&function, own)), "seed {seed}, state {state} of {states}: {function:?}");
                let over = program.over(&mut Floats { arguments: own, sines: function.sines }).expect("places that are written");
                assert_eq!(bits(found), bits(&over), "seed {seed}, over another arithmetic: {function:?}");
            }
            // One vector for all states.
            let shared = &given[1][..LENGTHS[1]];
            program.run(&[&given[0], shared], &mut result, &mut workspace).expect("lengths that fit");
            let last = &plain(&function, [&given[0][(states - 1) * 3..], shared]);
            assert_eq!(bits(&result[(states - 1) * 4..]), bits(last), "seed {seed}, {states} states");
        }
    }
}

/// Values that are all used at the end need more places than fit a large block.
#[test]
fn a_program_of_many_places_runs_in_small_blocks() {
    let count = 1000;
    let product =
        |i: usize| Operation { operator: Operator::Multiply, left: Operand::Value(0), right: Operand::Constant(i as f64) };
    let sum = |i: usize| Operation {
        operator: Operator::Add,
        left: Operand::Value(if i == 0 { 0 } else { count + i }),
        right: Operand::Value(count - i),
    };
    let function = Function {
        name: "sum".into(),
        arguments: vec![Argument { name: "q".into(), length: 1 }],
        results: vec![Result { name: "sum".into(), shape: vec![] }, Result { name: "first".into(), shape: vec![] }],
        sines: Sines::Fast,
        angles: Vec::new(),
        inputs: vec![Input::Entry { argument: 0, entry: 0 }],
        operations: (0..count).map(product).chain((0..count).map(sum)).collect(),
        outputs: [2 * count, 1].map(|value| Output { operand: Operand::Value(value), negated: false }).into(),
    };
    let program = Program::new(&function).expect("a valid function");
    let q: Vec<f64> = (0..100).map(f64::from).collect();
    let mut result = [0.0; 200];
    program.run(&[&q], &mut result, &mut program.workspace()).expect("lengths that fit");
    for (q, found) in q.iter().zip(result.chunks(2)) {
        // q + q (0 + 1 + ... + 999), exact in whole numbers
        assert_eq!(found, [q * 499_501.0, 0.0]);
    }
}

#[test]
fn a_function_that_uses_what_is_not_there_is_no_program() {
    let valid = random_function(&mut Random(1));
    let refused = |change: &dyn Fn(&mut Function<f64>)| {
        let mut function = valid.clone();
        change(&mut function);
        Program::new(&function).expect_err("a fault was planted").to_string()
    };
    let itself = valid.inputs.len();
    assert_eq!(
        refused(&|f| f.operations[0].left = Operand::Value(itself)),
        "operation 0 uses value 7, which does not stand before it"
    );
    assert_eq!(refused(&|f| f.outputs[1].operand = Operand::Value(1000)), "an output is value 1000, which does not exist");
    assert_eq!(
        refused(&|f| f.inputs[3] = Input::Entry { argument: 0, entry: 3 }),
        "input 3 is of an entry or an angle that does not exist"
    );
    assert_eq!(refused(&|f| f.inputs[0] = Input::Sine(2)), "input 0 is of an entry or an angle that does not exist");
    assert_eq!(refused(&|f| f.angles[1].terms.clear()), "angle 1 is not a sum that begins with an entry of an argument");
    assert_eq!(refused(&|f| f.outputs.truncate(3)), "the shapes of the results have 4 entries, and the function has 3 outputs");
}

#[test]
fn slices_of_other_lengths_are_refused() {
    let program = Program::new(&random_function(&mut Random(1))).expect("a valid function");
    let mut workspace = program.workspace();
    let (q, dq) = ([0.0; 6], [0.0; 4]);
    let mut refused = |arguments: &[&[f64]], result: usize| {
        program.run(arguments, &mut vec![0.0; result], &mut workspace).expect_err("a length does not fit").to_string()
    };
    assert_eq!(refused(&[&q], 8), "the function takes 2 arguments, not 1");
    assert_eq!(refused(&[&q, &dq], 7), "the result has 7 numbers, which is no multiple of the 4 of a state");
    assert_eq!(refused(&[&q[..5], &dq], 8), "`q` has 5 numbers, not 3 for all states, nor 3 for each of 2 states");
    let mut foreign = Workspace::default();
    assert_eq!(program.run(&[&q, &dq], &mut [0.0; 8], &mut foreign), Err(Mismatch::Workspace));
}

/// No result tells which instructions computed it, so this test reads its own: code that is not inlined has none of AVX2.
#[cfg(target_arch = "x86_64")]
#[test]
fn blocks_have_instructions_of_four_numbers() {
    if !installed::there("objdump", "binutils") {
        return;
    }
    let own = std::env::current_exe().expect("the test's program");
    let listing =
        std::process::Command::new("objdump").args(["-d", "--no-show-raw-insn"]).arg(own).output().expect("objdump runs");
    let listing = String::from_utf8_lossy(&listing.stdout);
    let of = |name: &str| listing.lines().filter(|line| line.contains(name) && line.contains("%ymm")).count();
    // Each instruction of a program has eight groups of eight numbers.
    assert!(of("vmulpd") >= 20 && of("vaddpd") >= 20, "{} products, {} sums", of("vmulpd"), of("vaddpd"));
}
