//! A program as linked: its sections, and the code size of each emitted function.

use object::{elf, Object, ObjectSection, ObjectSymbol, SectionFlags, SectionKind, SymbolKind};
use std::collections::BTreeMap;

/// Sizes in bytes.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Image {
    /// All code.
    pub(crate) text: u64,
    /// What lies in flash: code, constants, vectors, initial values.
    pub(crate) flash: u64,
    /// What lies in memory besides the stack.
    pub(crate) data: u64,
    /// Code size of the functions of emitted modules, by `MODULE::NAME`.
    pub(crate) functions: BTreeMap<String, u64>,
}

impl Image {
    pub(crate) fn read(bytes: &[u8]) -> Result<Image, object::Error> {
        let file = object::File::parse(bytes)?;
        let mut image = Image::default();
        for section in file.sections() {
            match section.kind() {
                SectionKind::Text => image.text += section.size(),
                SectionKind::Data | SectionKind::UninitializedData => image.data += section.size(),
                _ => {}
            }
            // All that is loaded: tables for unwinding and vectors too.
            let loaded = matches!(section.flags(), SectionFlags::Elf { sh_flags } if sh_flags & u64::from(elf::SHF_ALLOC) != 0);
            if loaded && section.kind() != SectionKind::UninitializedData {
                image.flash += section.size();
            }
        }
        for symbol in file.symbols().filter(|symbol| symbol.kind() == SymbolKind::Text) {
            let Ok(name) = symbol.name() else { continue };
            let name = format!("{:#}", rustc_demangle::demangle(name));
            if let Some(function) = name.strip_prefix("armgen_bare_functions::") {
                image.functions.insert(function.into(), symbol.size());
            }
        }
        Ok(image)
    }
}
