//! Packs the module of the generator, the script and the style into one HTML file: `armgen-playground MODULE.wasm OUT.html`.
//!
//! The files of `web/` become one script: each import names an earlier file, so imports go and exports lose their word.

use std::num::NonZeroU64;
use std::path::Path;
use std::process::ExitCode;

use sha2::{Digest, Sha256};

/// The files of the script, each after those that it imports.
const SCRIPT: [&str; 7] = [
    include_str!("../../web/elements.mjs"),
    include_str!("../../web/places.mjs"),
    include_str!("../../web/link.mjs"),
    include_str!("../../web/zip.mjs"),
    include_str!("../../web/editor.mjs"),
    include_str!("../../web/engine.mjs"),
    include_str!("../../web/playground.mjs"),
];
const WORKER: &str = include_str!("../../web/worker.mjs");
const STYLE: &str = include_str!("../../web/playground.css");
/// The page of a robot, whose colours the playground has.
const PAGE: &str = include_str!("../../../page/web/page.css");
const DOCUMENT: &str = include_str!("../../web/playground.html");

/// The examples; the playground begins with the first.
const ROBOTS: [(&str, &str); 4] = [
    ("scara", include_str!("../../../robots/scara.yaml")),
    ("ur5", include_str!("../../../robots/ur5.yaml")),
    ("panda7", include_str!("../../../robots/panda7.yaml")),
    ("puma560", include_str!("../../../robots/puma560.yaml")),
];

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [module, out] = arguments.as_slice() else {
        eprintln!("armgen-playground: name the module and the file to write");
        return ExitCode::from(2);
    };
    match std::fs::read(module).and_then(|module| write(Path::new(out), &document(&module, &packed(&module)?))) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("armgen-playground: {module}, {out}: {error}");
            ExitCode::from(2)
        }
    }
}

fn write(out: &Path, text: &str) -> std::io::Result<()> {
    println!("{}: {} bytes", out.display(), text.len());
    std::fs::write(out, text)
}

/// As few bytes as the `DecompressionStream` of browsers takes for the module: a twentieth fewer than by zlib, in seconds.
fn packed(module: &[u8]) -> std::io::Result<Vec<u8>> {
    let mut packed = Vec::new();
    let options = zopfli::Options { iteration_count: NonZeroU64::new(5).expect("above 0"), ..zopfli::Options::default() };
    zopfli::compress(options, zopfli::Format::Zlib, module, &mut packed)?;
    Ok(packed)
}

/// The whole file.
fn document(module: &[u8], packed: &[u8]) -> String {
    let script: String = SCRIPT.iter().map(|file| joined(file)).collect();
    let lines = STYLE.lines().map(str::trim_start).filter(|line| !line.starts_with("/*"));
    let style = palette() + &lines.collect::<Vec<_>>().join("\n");
    // A policy names the scripts of this file alone by it; the same input gives the same file.
    let hash = Sha256::new().chain_update(module).chain_update(&script).chain_update(WORKER).finalize();
    let nonce = base64(&hash[..12]);
    let robots: Vec<String> = ROBOTS.iter().map(|(name, text)| format!("{}:{}", quoted(name), quoted(text))).collect();
    let parts = [
        ("VERSION", env!("CARGO_PKG_VERSION")),
        ("STYLE", &style),
        ("NONCE", &nonce),
        ("WORKER", &joined(WORKER)),
        ("ROBOTS", &format!("{{{}}}", robots.join(","))),
        ("SCRIPT", &script),
        ("LENGTH", &packed.len().to_string()),
        ("PACKED", &dense(packed)),
    ];
    parts.iter().fold(DOCUMENT.to_owned(), |document, (mark, text)| document.replace(mark, text))
}

/// The colours of the page that the style of the playground names.
fn palette() -> String {
    let own = PAGE.lines().map(str::trim).skip_while(|line| *line != ":root {").take_while(|line| *line != "}");
    let named =
        |line: &&str| !line.starts_with("--") || STYLE.contains(&format!("var({})", line.split(':').next().unwrap_or_default()));
    own.filter(named).collect::<Vec<_>>().join("\n") + "\n}\n"
}

/// A file within the script: without imports, without the word `export`, without comments that have lines of their own.
fn joined(file: &str) -> String {
    let lines = file.lines().filter(|line| !line.starts_with("import "));
    let mut text = String::new();
    let mut within = false;
    for line in lines {
        let words = line.trim();
        let comment = within || words.starts_with("/**") || words.starts_with("//");
        let ends = words.ends_with("*/");
        // Code may follow a comment in its line.
        let is_comment = comment && (within || words.starts_with("//") || ends || !words.contains("*/"));
        within = is_comment && !words.starts_with("//") && !ends;
        if !is_comment && !words.is_empty() {
            text += words.strip_prefix("export ").unwrap_or(words);
            text.push('\n');
        }
    }
    text
}

/// A text as JSON that HTML may hold.
fn quoted(text: &str) -> String {
    let escaped = |c: char| match c {
        '"' | '\\' => format!("\\{c}"),
        '<' | '\0'..='\u{1f}' | '\u{2028}' | '\u{2029}' => format!("\\u{:04x}", u32::from(c)),
        c => c.to_string(),
    };
    format!("\"{}\"", text.chars().map(escaped).collect::<String>())
}

/// 13 bits as two characters of 91, none of which HTML reads in a script: a twelfth shorter than base64. `web/worker.mjs` reads it.
fn dense(bytes: &[u8]) -> String {
    let digit = |digit: u32| {
        let code = digit + u32::from(b'#');
        char::from_u32(code + u32::from(code >= u32::from(b'<'))).expect("a printable character")
    };
    let (mut text, mut word, mut bits) = (String::with_capacity(bytes.len() * 16 / 13 + 2), 0, 0);
    // With zeros enough for a last group.
    for byte in bytes.iter().chain([&0, &0]) {
        (word, bits) = (word << 8 | u32::from(*byte), bits + 8);
        if bits >= 13 {
            bits -= 13;
            let group = word >> bits;
            text.extend([digit(group / 91), digit(group % 91)]);
            word &= (1 << bits) - 1;
        }
    }
    text
}

/// RFC 4648 with padding.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for three in bytes.chunks(3) {
        let word = three.iter().chain([&0; 3]).take(3).fold(0, |word: usize, &byte| word << 8 | usize::from(byte));
        for k in 0..4 {
            let letter = char::from(LETTERS[word >> (18 - 6 * k) & 63]);
            text.push(if k <= three.len() { letter } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::{base64, dense, joined, palette, quoted, DOCUMENT, SCRIPT, STYLE, WORKER};

    #[test]
    fn base64_is_that_of_rfc_4648() {
        for (plain, coded) in [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")] {
            assert_eq!(base64(plain.as_bytes()), coded);
        }
    }

    /// As `web/worker.mjs` reads it.
    #[test]
    fn dense_texts_hold_their_bytes() {
        for length in 0..60 {
            let bytes: Vec<u8> = (0..length).map(|k: usize| (k * 151 + length * 17) as u8).collect();
            let text = dense(&bytes);
            assert!(!text.contains('<') && text.bytes().all(|c| c.is_ascii_graphic()), "{text}");
            let digit = |c: u8| u32::from(c - 35 - u8::from(c > 60));
            let (mut read, mut word, mut bits) = (Vec::new(), 0, 0);
            for pair in text.as_bytes().chunks(2) {
                (word, bits) = (word << 13 | (digit(pair[0]) * 91 + digit(pair[1])), bits + 13);
                while bits >= 8 {
                    bits -= 8;
                    read.push((word >> bits) as u8);
                }
                word &= (1 << bits) - 1;
            }
            assert_eq!(read[..length], bytes);
        }
    }

    #[test]
    fn texts_end_no_script() {
        assert_eq!(quoted("a\n\"</script>\\"), "\"a\\u000a\\\"\\u003c/script>\\\\\"");
        for file in SCRIPT.iter().chain([&WORKER]) {
            assert!(!file.contains("</script") && !file.contains("<!--"));
            assert!(!joined(file).contains("\nimport ") && !joined(file).contains("\nexport "));
        }
    }

    #[test]
    fn every_colour_of_the_style_is_there() {
        let style = palette() + STYLE;
        assert!(palette().contains("--accent:") && !palette().contains("--joint-edge"), "{}", palette());
        for used in STYLE.split("var(").skip(1).filter_map(|rest| rest.split(')').next()) {
            assert!(style.contains(&format!("{used}:")), "{used}");
        }
    }

    #[test]
    fn every_mark_of_the_document_is_there() {
        for mark in ["VERSION", "STYLE", "NONCE", "WORKER", "ROBOTS", "SCRIPT", "LENGTH", "PACKED"] {
            assert!(DOCUMENT.contains(mark), "{mark}");
        }
    }
}
