//! Rust text of a module: free functions over arrays, outer attributes only, so that the file serves as `mod robot;` and inside
//! `include!` alike. No path outside `core` and `libm`, no index that is not a constant, no `unsafe`, no attribute `cfg`.

mod batch;
mod body;
mod documentation;
mod inverse_kinematics;
mod literal;
mod runtime;
mod signature;
mod sincos;
pub(in crate::emit) mod written;

use armgen_elementary::texts::STRIBECK;
use proc_macro2::TokenStream;
use quote::{format_ident, quote, ToTokens};

use super::documentation::{self as common, Described, DescribedParameters};
use super::parameters::{has_payload, INDEX, RUST_INDEX, RUST_PAYLOAD};
use super::plain::{asks_for_exponentials, asks_for_signs};
use super::private::SIGN;
use super::{Language, Notes, Origin};
use crate::catalogue::{Absent, Length, Quantity, ResultPart, Sizes};
use crate::exact::Number;
use crate::kinds::Scalar;
use crate::parallel::parallel_map;
use crate::program::{EndEffector, Function, Joint, Module};
pub(super) use inverse_kinematics::{
    about_redundancy, about_target, entries as entries_of_postures, items as items_of_inverse_kinematics, meanings,
    what_is_invalid,
};
pub use inverse_kinematics::{print_inverse_kinematics, print_inverse_kinematics_test, print_inverse_kinematics_trait};
use literal::literal;
pub use runtime::single_traits;
pub(super) use signature::accesses;
use signature::{ignored, of_parts, structures, type_of, typed, usize_literal, with_fields};

/// The emitted module as text.
pub fn print(module: &Module, origin: &Origin, notes: &Notes) -> String {
    Text::of(module).documented(module, origin, notes)
}

/// The text of a module without the parts that receive notes: its head and the documentation of its functions.
#[derive(Clone, Debug)]
pub struct Text {
    before: String,
    functions: Vec<String>,
    after: String,
}

impl Text {
    /// Functions are formatted one by one, in parallel: a formatter needs many times the memory of its text.
    pub fn of(module: &Module) -> Text {
        let real = match module.scalar {
            Scalar::F64 => quote!(f64),
            Scalar::F32 => quote!(f32),
        };
        let constants = constants(module);
        let before = formatted(quote! {
            /// The scalar of all functions.
            #[allow(dead_code)]
            pub type Real = #real;
            #constants
        });
        let functions = parallel_map(&module.functions, |f| function(module, f));
        let (functions, has_barriers): (Vec<String>, Vec<bool>) = functions.into_iter().unzip();
        let private = private_block(module, has_barriers.contains(&true));
        let batches = module.batch.map(|lanes| batch::modules(module, lanes));
        Text { before, functions, after: formatted(quote!(#private #batches)) }
    }

    /// The whole text.
    pub fn documented(&self, module: &Module, origin: &Origin, notes: &Notes) -> String {
        let mut text = self.before.clone();
        for (function, own) in module.functions.iter().zip(&self.functions) {
            let note = notes.functions.get(&function.name()).map(String::as_str);
            for line in documentation::lines(&common::described(function, module).blocks(false, note)) {
                text += &format!("///{line}\n");
            }
            text += own;
        }
        commented(&crate::emit::head::of_module(module, Language::Rust, origin, &notes.head))
            + &absent(module)
            + &spaced(&(text + &self.after))
    }
}

/// Comments on the functions that the module lacks, with the reasons.
fn absent(module: &Module) -> String {
    let line = |absent: &Absent| format!("// There is no `{}`: {}.\n", absent.function, absent.reason);
    let lines: String = module.absent.iter().map(line).collect();
    if lines.is_empty() {
        lines
    } else {
        lines + "\n"
    }
}

/// The implementation of the runtime's traits for the module, as text for a separate file.
pub fn print_runtime(module: &Module, origin: &Origin) -> String {
    let lacking = runtime::lacking(module);
    let line = |(interface, functions): &(&str, Vec<String>)| {
        format!("// `{interface}` is not implemented: the module has no {}.\n", functions.join(", "))
    };
    let notes: String = lacking.iter().map(line).collect();
    let notes = if notes.is_empty() { notes } else { notes + "\n" };
    head(origin, &[]) + &notes + &runtime::implementation(module).map_or_else(String::new, format)
}

/// Whether the runtime's traits of dynamics are implemented for the module.
pub(in crate::emit) fn has_dynamics(module: &Module) -> bool {
    runtime::is_implemented(module, "Dynamics")
}

/// The comment with the origin of a file, and notes below it.
pub(in crate::emit) fn head(origin: &Origin, notes: &[String]) -> String {
    commented(&crate::emit::head::lines(origin, notes))
}

/// Lines of a head as comments.
fn commented(lines: &[String]) -> String {
    lines.iter().map(|line| format!("// {line}").trim_end().to_string() + "\n").collect::<String>() + "\n"
}

fn format(tokens: TokenStream) -> String {
    spaced(&formatted(tokens))
}

/// The tokens of a text that this program has put together.
fn tokens(text: &str) -> TokenStream {
    text.parse().expect("the emitted text is one of Rust")
}

fn formatted(tokens: TokenStream) -> String {
    prettyplease::unparse(&syn::parse2(tokens).expect("the emitted tokens are a Rust file"))
}

/// With a blank line between items, which reads better than the formatter's wall.
fn spaced(text: &str) -> String {
    let mut spaced = String::with_capacity(text.len() + 1024);
    let mut previous = "";
    for line in text.lines() {
        let starts = line.starts_with("///")
            || line.starts_with("pub ")
            || line.starts_with("fn ")
            || line.starts_with("impl")
            || line.starts_with("#[");
        let continues = previous.starts_with("///") || previous.starts_with("#[") || previous.is_empty();
        if starts && !continues {
            spaced.push('\n');
        }
        spaced.push_str(line);
        spaced.push('\n');
        previous = line;
    }
    spaced
}

fn constants(module: &Module) -> TokenStream {
    let (name, dof, parameters) = (&module.name, usize_literal(module.joints.len()), usize_literal(module.parameters.len()));
    let joint_names = module.joints.iter().map(|joint| &joint.name);
    let revolute = module.joints.iter().map(|joint| joint.is_revolute);
    let number = |value: &Option<Number>, infinite: TokenStream| match value {
        Some(value) => literal(value, module.scalar),
        None => infinite,
    };
    let infinity = || quote!(Real::INFINITY);
    let position = module.joints.iter().map(|joint| {
        let [low, high] = &joint.position;
        let (low, high) = (number(low, quote!(Real::NEG_INFINITY)), number(high, infinity()));
        quote!([#low, #high])
    });
    let sizes: [(&str, fn(&Joint) -> &Option<Number>); 4] = [
        ("VELOCITY_LIMITS", |joint| &joint.velocity),
        ("EFFORT_LIMITS", |joint| &joint.effort),
        ("ACCELERATION_LIMITS", |joint| &joint.acceleration),
        ("JERK_LIMITS", |joint| &joint.jerk),
    ];
    let parameter_names = module.parameters.iter().map(|parameter| &parameter.name);
    let nominal = module.parameters.iter().map(|parameter| literal(&parameter.nominal, module.scalar));
    let documented = documented_constants(module);
    let said = |constant: &str| documentation_of(&documented, constant);
    let [of_name, of_dof, of_joint_names, of_revolute] = ["NAME", "DOF", "JOINT_NAMES", "JOINT_IS_REVOLUTE"].map(said);
    let of_position = said("POSITION_LIMITS");
    let sizes = sizes.map(|(constant, of)| {
        let (said, name, values) =
            (said(constant), format_ident!("{constant}"), module.joints.iter().map(|joint| number(of(joint), infinity())));
        quote! {
            #said
            #[allow(dead_code, clippy::all)]
            pub const #name: [Real; DOF] = [#(#values),*];
        }
    });
    let [of_parameters, of_names, of_nominal] = ["PARAMETERS", "PARAMETER_NAMES", "NOMINAL_PARAMETERS"].map(said);
    let gravity = module.gravity_is_argument.then(|| {
        let (said, nominal) = (said("NOMINAL_GRAVITY"), module.gravity.iter().map(|component| literal(component, module.scalar)));
        quote! {
            #said
            #[allow(dead_code, clippy::all)]
            pub const NOMINAL_GRAVITY: [Real; 3] = [#(#nominal),*];
        }
    });
    let tasks = match module.tips.as_slice() {
        [] => task_constants("", &module.task, &documented),
        tips => end_effectors(tips, &documented),
    };
    let same_for_all = functions_of_parameters(module);
    let coupling = coupling_constants(module, &documented);
    let motors = motor_constants(module, &documented);
    let base = base_constants(module, &documented);
    let structures = structures(module, false);
    quote! {
        #of_name
        #[allow(dead_code)]
        pub const NAME: &str = #name;
        #of_dof
        #[allow(dead_code)]
        pub const DOF: usize = #dof;
        #of_joint_names
        #[allow(dead_code)]
        pub const JOINT_NAMES: [&str; DOF] = [#(#joint_names),*];
        #of_revolute
        #[allow(dead_code)]
        pub const JOINT_IS_REVOLUTE: [bool; DOF] = [#(#revolute),*];
        #of_position
        #[allow(dead_code, clippy::all)]
        pub const POSITION_LIMITS: [[Real; 2]; DOF] = [#(#position),*];
        #(#sizes)*
        #coupling
        #motors
        #tasks
        #of_parameters
        #[allow(dead_code)]
        pub const PARAMETERS: usize = #parameters;
        #of_names
        #[allow(dead_code)]
        pub const PARAMETER_NAMES: [&str; PARAMETERS] = [#(#parameter_names),*];
        #of_nominal
        #[allow(dead_code, clippy::all)]
        pub const NOMINAL_PARAMETERS: [Real; PARAMETERS] = [#(#nominal),*];
        #same_for_all
        #gravity
        #base
        #(#structures)*
    }
}

/// The functions over parameters that are the same in every module that has them.
fn functions_of_parameters(module: &Module) -> TokenStream {
    let index = (!module.parameters.is_empty()).then(|| {
        let (title, function) = (format!(" {INDEX}"), tokens(RUST_INDEX));
        quote! {
            #[doc = #title]
            #[doc = ""]
            #[doc = " `None` for a name that no parameter has. It may initialise a constant."]
            #function
        }
    });
    let payload = has_payload(module).then(|| {
        let (lines, function) = (documentation::lines(&super::parameters::payload_blocks()), tokens(RUST_PAYLOAD));
        quote!(#(#[doc = #lines])* #function)
    });
    quote!(#index #payload)
}

/// The documentation of a function in a module without error bounds.
#[doc(hidden)]
pub fn function_documentation(described: &Described<'_>) -> Vec<String> {
    documentation::lines(&described.blocks(false, None))
}

/// The documentation of constants, by their names.
#[doc(hidden)]
pub fn constants_documentation(described: &DescribedParameters) -> Vec<(String, Vec<String>)> {
    super::plain::constants_documentation(described, 0)
        .into_iter()
        .map(|(name, blocks)| (name, documentation::lines(&blocks)))
        .collect()
}

/// The documentation of the constants of a module.
fn documented_constants(module: &Module) -> Vec<(String, Vec<String>)> {
    constants_documentation(&DescribedParameters::of(module))
}

/// The documentation of one of them.
fn documentation_of(all: &[(String, Vec<String>)], constant: &str) -> TokenStream {
    let lines = all.iter().find(|(name, _)| *name == constant).map_or(&[][..], |(_, lines)| lines);
    quote!(#(#[doc = #lines])*)
}

/// The coupling of joints.
fn coupling_constants(module: &Module, documented: &[(String, Vec<String>)]) -> Option<TokenStream> {
    let coupling = module.coupling.as_ref()?;
    let said = |constant: &str| documentation_of(documented, constant);
    let [of_count, of_names, of_factors, of_offsets] = ["JOINTS", "ALL_JOINT_NAMES", "COUPLING", "COUPLING_OFFSET"].map(said);
    let (count, names) = (usize_literal(coupling.names.len()), &coupling.names);
    let numbers = |row: &[Number]| row.iter().map(|value| literal(value, module.scalar)).collect::<Vec<_>>();
    let rows = coupling.factors.iter().map(|row| {
        let row = numbers(row);
        quote!([#(#row),*])
    });
    let offsets = numbers(&coupling.offsets);
    Some(quote! {
        #of_count
        #[allow(dead_code)]
        pub const JOINTS: usize = #count;
        #of_names
        #[allow(dead_code)]
        pub const ALL_JOINT_NAMES: [&str; JOINTS] = [#(#names),*];
        #of_factors
        #[allow(dead_code, clippy::all)]
        pub const COUPLING: [[Real; DOF]; JOINTS] = [#(#rows),*];
        #of_offsets
        #[allow(dead_code, clippy::all)]
        pub const COUPLING_OFFSET: [Real; JOINTS] = [#(#offsets),*];
    })
}

/// The speeds of motors.
fn motor_constants(module: &Module, documented: &[(String, Vec<String>)]) -> Option<TokenStream> {
    let motors = module.motors.as_ref()?;
    let [of_count, of_rates] = ["MOTORS", "MOTOR_RATES"].map(|constant| documentation_of(documented, constant));
    let count = usize_literal(motors.joints.len());
    let rows = motors.rates.iter().map(|row| {
        let row = row.iter().map(|value| literal(value, module.scalar));
        quote!([#(#row),*])
    });
    Some(quote! {
        #of_count
        #[allow(dead_code)]
        pub const MOTORS: usize = #count;
        #of_rates
        #[allow(dead_code, clippy::all)]
        pub const MOTOR_RATES: [[Real; DOF]; MOTORS] = [#(#rows),*];
    })
}

/// The rows of a task; `tip` is what its names begin with.
fn task_constants(tip: &str, rows: &[usize], documented: &[(String, Vec<String>)]) -> TokenStream {
    let [rows_name, task_name] = ["TASK_ROWS", "TASK"].map(|name| format!("{tip}{name}"));
    let [of_rows, of_task] = [&rows_name, &task_name].map(|name| documentation_of(documented, name));
    let [rows_name, task_name] = [rows_name, task_name].map(|name| format_ident!("{name}"));
    let (count, task) = (usize_literal(rows.len()), rows.iter().map(|&row| usize_literal(row)));
    quote! {
        #of_rows
        #[allow(dead_code)]
        pub const #rows_name: usize = #count;
        #of_task
        #[allow(dead_code)]
        pub const #task_name: [usize; #rows_name] = [#(#task),*];
    }
}

/// The constants of named end effectors.
fn end_effectors(tips: &[EndEffector], documented: &[(String, Vec<String>)]) -> TokenStream {
    let (of_tips, count, names) =
        (documentation_of(documented, "TIPS"), usize_literal(tips.len()), tips.iter().map(|tip| &tip.name));
    let each = tips.iter().map(|tip| {
        let task = task_constants(&tip.constant(""), &tip.task, documented);
        let name = tip.constant("COORDINATES");
        let said = documentation_of(documented, &name);
        let (name, count) = (format_ident!("{name}"), usize_literal(tip.coordinates.len()));
        let joints = tip.coordinates.iter().map(|&joint| usize_literal(joint));
        quote! {
            #task
            #said
            #[allow(dead_code)]
            pub const #name: [usize; #count] = [#(#joints),*];
        }
    });
    quote! {
        #of_tips
        #[allow(dead_code)]
        pub const TIPS: [&str; #count] = [#(#names),*];
        #(#each)*
    }
}

/// The base parameters, for the function that has them.
fn base_constants(module: &Module, documented: &[(String, Vec<String>)]) -> Option<TokenStream> {
    if !common::has_base_parameters(module) {
        return None;
    }
    let count = usize_literal(module.base_set.len());
    let names = module.base_set.iter().map(|parameter| &parameter.name);
    let nominal = module.base_set.iter().map(|parameter| literal(&parameter.nominal, module.scalar));
    let said = |constant: &str| documentation_of(documented, constant);
    let [of_count, of_names, of_nominal] = ["BASE_PARAMETERS", "BASE_PARAMETER_NAMES", "NOMINAL_BASE_PARAMETERS"].map(said);
    Some(quote! {
        #of_count
        #[allow(dead_code)]
        pub const BASE_PARAMETERS: usize = #count;
        #of_names
        #[allow(dead_code)]
        pub const BASE_PARAMETER_NAMES: [&str; BASE_PARAMETERS] = [#(#names),*];
        #of_nominal
        #[allow(dead_code, clippy::all)]
        pub const NOMINAL_BASE_PARAMETERS: [Real; BASE_PARAMETERS] = [#(#nominal),*];
    })
}

/// A function without its documentation, with its parts; and whether it has barriers.
fn function(module: &Module, function: &Function) -> (String, bool) {
    let (ignored, sines) = (ignored(function), sincos::lines(module, function));
    let (body, first, sizes) = (body::body(module, function), quote!(#ignored #(#sines)*), module.sizes());
    let is_written = written::is_written(function, &sizes);
    let own = if is_written {
        written::function(function, &first, &body, &sizes)
    } else {
        let (name, returns) = (format_ident!("{}", function.name()), type_of(function.quantity));
        let arguments = function.arguments.iter().map(typed);
        let frame = quote! {
            #[allow(dead_code, clippy::all)]
            pub fn #name(#(#arguments),*) -> #returns {}
        };
        let entries: Vec<TokenStream> = body.entries.iter().map(|entry| tokens(entry)).collect();
        body::framed(frame, &first, &body.lines, &result(function.quantity, &entries, &sizes))
    };
    (body.parts.into_iter().fold(own, |text, part| text + &part), is_written && body.groups.len() > 1)
}

/// The value of a result from its entries.
fn result(quantity: &Quantity, entries: &[TokenStream], sizes: &Sizes) -> TokenStream {
    let mut rest = entries;
    let mut part = |part: &ResultPart| {
        let (own, others) = rest.split_at(part.len(sizes));
        rest = others;
        nested(part.lengths, own, sizes)
    };
    result_of(quantity, &mut part)
}

/// The value of a result whose parts are these.
fn result_of(quantity: &Quantity, mut part: impl FnMut(&ResultPart) -> TokenStream) -> TokenStream {
    match (quantity.result, quantity.structure) {
        ([_, _, ..], Some(named)) => with_fields(&format_ident!("{}", named.name), quantity, part),
        _ => of_parts(quantity, &mut part, |_| quote!()),
    }
}

fn nested(lengths: &[Length], entries: &[TokenStream], sizes: &Sizes) -> TokenStream {
    let Some((outer, inner)) = lengths.split_first() else { return entries[0].clone() };
    let count = outer.of(sizes);
    let each = entries.len() / count.max(1);
    let rows = (0..count).map(|i| nested(inner, &entries[i * each..(i + 1) * each], sizes));
    quote!([#(#rows),*])
}

/// Whether any function needs a sine or a cosine.
pub(in crate::emit) fn asks_for_sines(module: &Module) -> bool {
    module.functions.iter().flat_map(Function::symbols).any(|symbol| symbol.angle().is_some())
}

/// Functions that emitted functions call besides their parts and result writers: sine and cosine, the sign of a rate, the share
/// of Stribeck friction, and the barrier.
fn private_block(module: &Module, has_barriers: bool) -> TokenStream {
    let sin_cos = asks_for_sines(module).then(|| sincos::functions(module));
    let sign = asks_for_signs(module).then(|| {
        let said = format!(" {SIGN}");
        quote! {
            #[doc = #said]
            #[inline]
            fn sign(x: Real) -> Real {
                if x > 0.0 {
                    1.0
                } else if x < 0.0 {
                    -1.0
                } else {
                    x
                }
            }
        }
    });
    let stribeck = asks_for_exponentials(module).then(|| {
        let file: syn::File = syn::parse_str(STRIBECK).expect("the text to take in is a Rust file");
        file.into_token_stream()
    });
    let barrier = has_barriers.then(written::barrier);
    quote!(#sin_cos #sign #stribeck #barrier)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::program::{Operand, Operation, Output, Step};
    use crate::schedule::{self, Options};
    use crate::source::Source;
    use crate::{validate, Model};

    fn module(robot: &str, options: &Options) -> Module {
        let path = format!("{}/../{robot}.yaml", env!("CARGO_MANIFEST_DIR"));
        let source = Source::new("robot.yaml", std::fs::read_to_string(path).expect("a robot"));
        let (manipulator, _) = validate::read(&source).0.expect("it is valid");
        schedule::module(&Model::new(manipulator), options)
    }

    /// Formatting the text of a function changes nothing; how many lines continue the one before.
    fn check(module: &Module) -> usize {
        for of in &module.functions {
            let text = function(module, of).0;
            assert_eq!(text, formatted(tokens(&text)), "{}", of.name());
        }
        let continues = |line: &&str| line.trim_start().starts_with(['+', '-', '*']) && line.starts_with("        ");
        module.functions.iter().map(|of| function(module, of).0.lines().filter(continues).count()).sum()
    }

    #[test]
    fn lines_are_written_as_the_formatter_writes_them() {
        let fused = Options { fuse: true, scalar: Scalar::F32, ..Options::default() };
        let everything = module("tests/robots/everything", &fused);
        assert!(check(&everything) > 0);
        let mut long = module("tests/robots/general_angles", &Options::default());
        assert!(check(&long) > 0);
        // So long that it comes in parts: each step is used twice.
        let gravity = long.functions.iter_mut().find(|of| of.name() == "gravity").expect("every arm with mass has it");
        let step =
            |left: u32, right: u32| Step { operation: Operation::Add, left: Operand::Step(left), right: Operand::Step(right) };
        let first = gravity.steps.len() as u32;
        gravity.steps.extend((first..first + 9000).map(|i| step(i - 1, i - 2)));
        let last = Output { operand: Operand::Step(first + 8999), negated: false };
        gravity.outputs.iter_mut().for_each(|output| *output = last.clone());
        assert!(function(&long, long.functions.iter().find(|of| of.name() == "gravity").expect("as before"))
            .0
            .contains("_part_7("));
        check(&long);
    }
}
