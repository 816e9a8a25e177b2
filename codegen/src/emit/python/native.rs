//! `robot_native.py`: the functions for many states as a library of C, compiled where it is used, with arrays of NumPy in and out.

use std::fmt::Write;

use super::{link, result_type, structure};
use crate::emit::c;
use crate::emit::documentation::{self, Block};
use crate::emit::plain::head;
use crate::emit::{Language, Notes, Origin};
use crate::kinds::Scalar;
use crate::program::Module;

const LOAD: &str = include_str!("native.py");

/// The source of the library and the module that compiles and calls it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Native {
    /// `robot_native.c`
    pub c: String,
    /// `robot_native.py`
    pub python: String,
}

/// Both files.
pub fn print(module: &Module, origin: &Origin) -> Native {
    let lanes = match module.scalar {
        Scalar::F64 => 8,
        Scalar::F32 => 16,
    };
    let mut text = head(module, Language::Python, origin, &Notes::default(), "#");
    text +=
        "\n\"\"\"The functions as a library of C, for many states at a time: `load()` compiles it where it is used.\"\"\"\n\n";
    text += "from __future__ import annotations\n\nimport ctypes\nimport hashlib\nimport math\nimport os\nimport platform\nimport shlex\nimport shutil\n";
    text += "import subprocess\nimport sys\nimport tempfile\nimport threading\nfrom pathlib import Path\nfrom typing import Any, NamedTuple, Optional, Sequence, Tuple\n\n";
    text += "import numpy as np\n\n__all__ = [\"Native\", \"load\"]\n";
    let dtype = match module.scalar {
        Scalar::F64 => "float64",
        Scalar::F32 => "float32",
    };
    let _ = write!(text, "\n_NAME = \"{}\"\n_DTYPE = np.{dtype}\n{LOAD}", module.name);
    let functions = &module.functions;
    let mut known = Vec::new();
    text += "\n";
    functions.iter().for_each(|function| result_type(&mut text, function.quantity, &mut known));
    text += "\nclass Native:\n    \"\"\"The functions of the library: arrays of NumPy in and out, leading axes are those of many states.\"\"\"\n";
    text += "\n    def __init__(self, library: Any) -> None:\n";
    for function in functions {
        let arguments = function.arguments.iter().map(|a| format!("(\"{}\", {}), ", a.name(), a.length().of(&module.sizes())));
        let lengths = |lengths: Vec<String>| match lengths.as_slice() {
            [] => "()".to_string(),
            lengths => format!("({},)", lengths.join(", ")),
        };
        let results = function.quantity.result.iter();
        let results = results
            .map(|part| lengths(part.lengths.iter().map(|length| length.of(&module.sizes()).to_string()).collect()) + ", ");
        let _ = writeln!(
            text,
            "        self._{0} = _Function(library.armgen_{0}, ({1}), ({2}))",
            function.name(),
            arguments.collect::<String>().trim_end(),
            results.collect::<String>().trim_end()
        );
    }
    for function in functions {
        let names: Vec<&str> = function.arguments.iter().map(|a| a.name()).collect();
        let signature: String = names.iter().map(|name| format!(", {name}: Any")).collect();
        let title = documentation::function(function, module, true).into_iter().take(1).collect::<Vec<Block>>();
        let title = documentation::plain(&title, &link).join(" ");
        let returns = structure(function.quantity).unwrap_or("Any".into());
        let _ = writeln!(
            text,
            "\n    def {}(self{signature}, *, threads: int = 1) -> {returns}:\n        \"\"\"{title}\"\"\"",
            function.name()
        );
        let call = format!("self._{}({}, threads=threads)", function.name(), names.join(", "));
        let _ = match structure(function.quantity) {
            Some(name) => writeln!(text, "        return {name}(*{call})"),
            None => writeln!(text, "        return {call}[0]"),
        };
    }
    Native { c: c::library(module, origin, lanes), python: text }
}
