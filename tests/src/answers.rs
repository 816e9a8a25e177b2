//! The functions of an emitted module by their names. `emitted.rs` asks the modules of this crate; `compiled.rs` writes this file into the
//! project that it compiles others in. Who takes the macros in has a type `Arguments` in scope.

/// Numbers, however they are nested, in order.
pub(crate) trait Flat {
    fn flat(self) -> Vec<f64>;
}

impl Flat for f64 {
    fn flat(self) -> Vec<f64> {
        vec![self]
    }
}

impl Flat for f32 {
    fn flat(self) -> Vec<f64> {
        vec![f64::from(self)]
    }
}

impl<T: Flat, const N: usize> Flat for [T; N] {
    fn flat(self) -> Vec<f64> {
        self.into_iter().flat_map(Flat::flat).collect()
    }
}

impl<A: Flat, B: Flat> Flat for (A, B) {
    fn flat(self) -> Vec<f64> {
        [self.0.flat(), self.1.flat()].concat()
    }
}

impl<A: Flat, B: Flat, C: Flat> Flat for (A, B, C) {
    fn flat(self) -> Vec<f64> {
        [self.0.flat(), self.1.flat(), self.2.flat()].concat()
    }
}

/// `Real` of a module.
pub(crate) trait Float: Copy {
    fn nearest(x: f64) -> Self;
}

impl Float for f64 {
    fn nearest(x: f64) -> f64 {
        x
    }
}

impl Float for f32 {
    fn nearest(x: f64) -> f32 {
        x as f32
    }
}

/// The array that an emitted function takes.
pub(crate) fn array<T: Float, const N: usize>(values: &[f64]) -> [T; N] {
    assert_eq!(values.len(), N, "as many numbers as the function takes");
    std::array::from_fn(|i| T::nearest(values[i]))
}

/// Calls a function of a module: `call!(module::function, arguments, names of those that it takes...)`.
macro_rules! call {
    ($module:ident :: $function:ident, $a:ident, $($argument:ident),*) => {
        $module::$function($(&$crate::answers::array(&$a.$argument)),*)
    };
}

/// Makes the type of a module's `equations_of_motion` numbers in order.
macro_rules! flat {
    ($module:ident) => {
        impl Flat for $module::EquationsOfMotion {
            fn flat(self) -> Vec<f64> {
                [self.inertia.flat(), self.coriolis.flat(), self.gravity.flat()].concat()
            }
        }
    };
}

/// The function that answers for a module: `answers!(module; function(argument, ..), ..)` with all of its functions.
macro_rules! answers {
    ($module:ident; $($function:ident($($argument:ident),*)),*) => {{
        fn answer(function: &str, a: &Arguments) -> Vec<f64> {
            match function {
                "dof" => vec![$module::DOF as f64],
                "nominal" => $module::NOMINAL_PARAMETERS.flat(),
                "nominal_base" => $module::NOMINAL_BASE_PARAMETERS.flat(),
                $(stringify!($function) => call!($module::$function, a, $($argument),*).flat(),)*
                _ => panic!("no function `{function}`"),
            }
        }
        answer
    }};
}
