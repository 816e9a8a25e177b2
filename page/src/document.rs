//! The HTML of a page: all static content, and empty elements that the script fills.

use std::borrow::Cow;
use std::fmt::Write;

use armgen_codegen::description::{Convention, RobotDescription};
use armgen_codegen::Model;
use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::html::{base64, decimal, escape, json};
use crate::rows::{convention, Row};
use crate::{bodies, sheet, warnings};

const STYLE: &str = include_str!("../web/page.css");
/// The style sheet of the plotting library.
const PLOTS: &str = include_str!("../vendor/uPlot-1.6.32/uPlot.min.css");

/// The parts of a page.
pub(crate) struct Parts<'p> {
    pub(crate) model: &'p Model,
    pub(crate) description: &'p RobotDescription,
    pub(crate) rows: &'p [Row],
    pub(crate) warnings: warnings::Warnings<'p>,
    /// Tables of motors, friction, limits and parameters.
    pub(crate) drives: &'p str,
    pub(crate) equations: &'p str,
    pub(crate) cost: &'p str,
    /// Heading and content of the section about logs or experiments; `None` if there are no runs.
    pub(crate) logs: Option<(&'static str, String)>,
    /// The input of the script.
    pub(crate) data: &'p Value,
    pub(crate) script: &'p str,
    /// Marks script and style for the policy of a window around the page.
    pub(crate) nonce: Option<&'p str>,
}

/// In place of a section that comes later.
pub(crate) const LATER: &str = "<p class=\"small\" data-later role=\"status\">Being derived …</p>\n";

/// The whole page.
pub(crate) fn document(parts: &Parts<'_>) -> String {
    // Only readers of `page/web` need indentation, line ends, and comments, which have their own lines.
    let lines = STYLE.lines().map(str::trim_start).filter(|line| !line.starts_with("/*"));
    let own: String = lines.flat_map(|line| [line, if line.ends_with([',', ';', '{', '}']) { "" } else { "\n" }]).collect();
    let style = if parts.logs.is_some() { format!("{PLOTS}\n{own}") } else { own };
    let name = escape(&parts.model.manipulator.name);
    let nonce = parts.nonce.map_or_else(String::new, |nonce| format!(" nonce=\"{}\"", escape(nonce)));
    let mut text = String::from("<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n");
    let _ = write!(
        text,
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src '{}'; style-src '{}'; img-src data:\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"generator\" content=\"armgen {}\">\n\
         <link rel=\"icon\" href=\"data:,\">\n<title>{name}</title>\n<style{nonce}>{style}</style>\n</head>\n<body>\n",
        hash(parts.script),
        hash(&style),
        env!("CARGO_PKG_VERSION"),
    );
    text += &header(parts);
    let sections = sections(parts);
    text += "<main>\n<nav aria-label=\"Sections\">";
    for (id, title, _) in &sections {
        // A short title keeps the table of contents on a single line.
        let brief = title.split(" against").next().unwrap_or(title);
        let _ = write!(text, "<a href=\"#{id}\">{brief}</a>");
        if *id == "numbers" {
            text += "<a href=\"#singular\">Singular postures</a>";
        }
    }
    text += "</nav>\n";
    text += ARM;
    let of_coordinates = parts.model.manipulator.coordinates();
    text += &sliders(of_coordinates.iter().map(|coordinate| &parts.rows[coordinate.index]));
    text += "</section>\n<div id=\"content\">\n";
    for (id, title, content) in &sections {
        let _ = write!(
            text,
            "<section id=\"{id}\" aria-labelledby=\"{id}-title\">\n<h2 id=\"{id}-title\">{title}</h2>\n{content}</section>\n"
        );
    }
    text += "</div>\n</main>\n<noscript><p class=\"warning\">Without scripts this page shows its tables only: no picture, no numbers.</p></noscript>\n";
    let _ = write!(
        text,
        "<script type=\"application/json\" id=\"data\">{}</script>\n<script type=\"module\"{nonce}>{}</script>\n</body>\n</html>\n",
        json(parts.data),
        parts.script
    );
    text
}

/// The sections next to the picture: identifier, title, content.
fn sections<'p>(parts: &'p Parts<'_>) -> Vec<(&'static str, &'static str, Cow<'p, str>)> {
    let table = sheet::table(parts.rows, convention(parts.description), &parts.warnings);
    let frames = "<details open><summary>Frames</summary><div id=\"frames\"></div></details>\n";
    let bodies = "<details open><summary>Bodies</summary><div id=\"bodies\"></div></details>\n";
    let mut all = vec![
        ("data-sheet", "Data sheet", (table + frames + bodies + parts.drives).into()),
        ("numbers", "Numbers", NUMBERS.into()),
        ("equations", "Equations", parts.equations.into()),
        ("workspace", "Workspace", WORKSPACE.into()),
    ];
    if parts.model.manipulator.coupling.is_none() {
        all.insert(1, ("check", "Check against the real arm", CHECK.into()));
    }
    all.extend(parts.logs.iter().map(|(title, logs)| ("logs", *title, logs.into())));
    all.push(("cost", "Cost", parts.cost.into()));
    all
}

fn header(parts: &Parts<'_>) -> String {
    let manipulator = &parts.model.manipulator;
    let joints = manipulator.joints.len();
    let coordinates = manipulator.coupling.as_ref().map_or(String::new(), |_| {
        format!(", {} coordinate{}", manipulator.dof(), if manipulator.dof() == 1 { "" } else { "s" })
    });
    let rows = match convention(parts.description) {
        Convention::Standard => "standard DH",
        Convention::Modified => "modified DH",
        Convention::Urdf => "rows of a URDF",
    };
    // The page has the first of several end effectors.
    let tips = parts.description.tips.as_ref().map_or(&[][..], |tips| &tips.value);
    let end = tips.first().and_then(|tip| tip.name.as_ref()).filter(|_| tips.len() > 1);
    let end = end.map_or(String::new(), |name| format!(", end effector e: {}, the first of {}", escape(&name.value), tips.len()));
    format!(
        "<header>\n<h1>{}</h1>\n<p>{joints} joint{}{coordinates}, {rows}, {} kg{end}</p>\n<div class=\"controls\">\n\
         <button type=\"button\" id=\"angle-unit\">angles: rad</button>\n\
         <button type=\"button\" id=\"length-unit\">lengths: m</button>\n\
         <button type=\"button\" id=\"theme\">dark theme</button>\n<button type=\"button\" id=\"unfold\" title=\"all that is folded in, but runs; of long equations as many as can be printed\">open all</button>\n<button type=\"button\" id=\"print\">print</button>\n</div>\n<p id=\"unfold-said\" class=\"small\" role=\"status\"></p>\n</header>\n",
        escape(&manipulator.name),
        if joints == 1 { "" } else { "s" },
        decimal(bodies::total_mass(manipulator)),
    )
}

const ARM: &str = r##"<section id="arm-pane" aria-label="The arm">
<div id="picture-place"><div class="picture"><svg id="arm" viewBox="0 0 600 480" role="img" tabindex="0" aria-labelledby="arm-title arm-description">
<title id="arm-title">The arm</title><desc id="arm-description"></desc>
</svg><p id="singular-posture" role="status"></p></div></div>
<p id="grid-step" class="small"></p>
<p class="small">Axes of the frames: x red, solid; y green, dashed; z blue, dotted. <span class="keys">Drag turns, the wheel zooms, in a narrow window with Ctrl or after a click; keys: arrows, + −, 1 2 3 0.</span></p>
<div class="controls" role="group" aria-label="View">
<button type="button" data-view="front" title="x to the right, z up">front</button><button type="button" data-view="side" title="y to the right, z up">side</button><button type="button" data-view="top" title="x to the right, y up">top</button><button type="button" data-view="oblique">oblique</button>
</div>
<div class="controls layers" role="group" aria-label="Shown in the picture">
<label><input type="checkbox" id="show-frames" checked> frames</label>
<label><input type="checkbox" id="show-links" checked> links</label>
<label><input type="checkbox" id="show-bodies"> bodies</label>
<label><input type="checkbox" id="show-grid" checked> grid</label>
<label><input type="checkbox" id="show-points"> workspace</label>
<label><input type="checkbox" id="show-velocity"> velocity ellipsoid</label>
<label><input type="checkbox" id="show-force"> force ellipsoid</label>
<label><input type="checkbox" id="show-lost" checked> lost motion</label>
</div>
"##;

const CHECK: &str = r#"<p>Does the description agree with the arm in the laboratory? Paste what its controller says, a posture and its pose a line: <code>q1 … qn x y z</code> or <code>q1 … qn x y z roll pitch yaw</code>.
x y z are those of the end effector in the base frame, the orientation is Rz(yaw) Ry(pitch) Rx(roll), units are those chosen above.
The page says how far its own arm is from each pose, and which single mistake in the rows would explain the difference.</p>
<details><summary>What is looked for, and what the difference is</summary>
<p>In a row: a wrong sign, 90° or 180° too many or too few, a and d exchanged, a factor of 1000, a joint that counts the other way. Of the whole: the other convention, a tool left out. Not: wrong lengths, and offsets of zero.</p>
<p>The difference is the root mean square of distances and of angles times the size of the arm; below a thousandth of that size the arm agrees. Other units convert what stands in the field.</p></details>
<label for="measured">Measured postures and poses</label>
<textarea id="measured" rows="4" spellcheck="false"></textarea>
<div class="controls"><button type="button" id="measured-add">add the pose that is shown</button></div>
<div id="measured-said" role="status"></div>
<ol id="suspects"></ol>
"#;

const NUMBERS: &str = "<p class=\"small\">At the posture, rates and accelerations of the sliders; always in m, rad, s, kg and N, whatever units are chosen above. Six digits are shown, and 0 where rounding alone has left something<span class=\"keys\">; copies have all digits of what was computed, such as −5.6e−17</span>.</p>
<p id=\"followed\" class=\"near\"></p>
<div id=\"quantities\"></div>
";

const WORKSPACE: &str = r#"<details id="postures"><summary>Other postures at this pose</summary>
<p id="postures-said" role="status"></p>
<div class="controls"><label id="postures-held-label" hidden>joint that is held <select id="postures-held"></select></label></div>
<div id="postures-found"></div></details>
<details id="reach"><summary>Where the end effector comes to</summary><div class="figures"></div></details>
<details id="w-map"><summary>Manipulability over two joints</summary>
<div class="controls"><label>across <select id="w-first"></select></label><label>up <select id="w-second"></select></label></div>
<div class="map"><p class="up" id="w-up"></p><canvas id="w-canvas" width="384" height="384" role="img" aria-labelledby="w-said"></canvas><p class="across" id="w-across"></p></div><p id="w-said" class="small"></p></details>
"#;

fn sliders<'r>(rows: impl Iterator<Item = &'r Row>) -> String {
    let mut text = String::from(
        "<div id=\"sliders\">\n<p class=\"small\">Sliders go to the limits, else to ±π rad or ±1 m; fields take any number, also as −pi/4, which is in rad always, or as 30 deg, when Enter is pressed or the field is left; a list of numbers sets the joints from there on, or all. <i>q̇</i>, <i>q̈</i>: rates and accelerations, per s and s².</p>\n",
    );
    for (i, row) in rows.enumerate() {
        let k = i + 1;
        let name = escape(&row.name);
        let unit = if row.revolute { "rad" } else { "m" };
        let _ = writeln!(
            text,
            "<div class=\"joint\" data-joint=\"{k}\"><label for=\"q{k}\"><i>q</i><sub>{k}</sub> {name}</label>\
             <input type=\"range\" id=\"q{k}\" step=\"any\">\
             <span class=\"exact\"><input type=\"text\" id=\"q{k}-value\" autocomplete=\"off\" spellcheck=\"false\" aria-label=\"q{k}, exact\" aria-describedby=\"q{k}-unit q{k}-fault\"></span><span class=\"unit\" id=\"q{k}-unit\" data-unit=\"{unit}\">{unit}</span>\
             <label class=\"rate\"><i>q̇</i> <span class=\"exact\"><input type=\"text\" autocomplete=\"off\" id=\"dq{k}\" value=\"0\" aria-label=\"rate of q{k}\" aria-describedby=\"dq{k}-unit q{k}-fault\"></span> <span class=\"unit\" id=\"dq{k}-unit\"><span data-unit=\"{unit}\">{unit}</span>/s</span></label>\
             <label class=\"rate\"><i>q̈</i> <span class=\"exact\"><input type=\"text\" autocomplete=\"off\" id=\"ddq{k}\" value=\"0\" aria-label=\"acceleration of q{k}\" aria-describedby=\"ddq{k}-unit q{k}-fault\"></span> <span class=\"unit\" id=\"ddq{k}-unit\"><span data-unit=\"{unit}\">{unit}</span>/s²</span></label>\
             <span class=\"outside\" id=\"q{k}-outside\" hidden>outside its limits</span><span class=\"outside\" id=\"q{k}-fault\" role=\"status\" hidden></span></div>"
        );
    }
    text + "</div>\n<div class=\"controls\"><button type=\"button\" id=\"zero\">zero</button><button type=\"button\" id=\"play\" aria-pressed=\"false\" title=\"one joint after the other through its range\">sweep joints</button><button type=\"button\" id=\"copy-q\">copy q</button><span id=\"said\" role=\"status\"></span></div>\n<p id=\"ellipsoid-axes\" class=\"small\"></p>\n"
}

/// The CSP source expression that allows exactly this text.
fn hash(text: &str) -> String {
    format!("sha256-{}", base64(&Sha256::digest(text.as_bytes())))
}
