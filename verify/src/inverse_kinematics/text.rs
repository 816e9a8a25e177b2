//! Reads the text of a module of inverse kinematics: its constants and its construction; checks the rest against the required text.
//!
//! Comments and blanks have no meaning. The rest must consist of the exporting head, constants, one function whose body is that of a
//! construction, and building blocks. Each block must equal, byte for byte, the one that this program contains, compiles and tests.

use armgen_inverse_kinematics::texts::TEXTS;

/// The value of a constant.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value {
    /// A number with its sign, as in the text.
    Number(String),
    Bool(bool),
    /// Any other single word or text.
    Word(String),
    List(Vec<Value>),
    Fields(Vec<(String, Value)>),
}

/// A loop of the text.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Arrangement {
    pub(super) order: Vec<usize>,
    pub(super) prismatic: Vec<bool>,
    pub(super) open: usize,
    pub(super) backward: bool,
    /// The place of the link that the given joint moves, if it lies between two other joints.
    pub(super) moved: Option<usize>,
    /// All its numbers as in the text: links, before, after, offsets.
    pub(super) numbers: Vec<String>,
}

/// A joint with a given value.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Given {
    pub(super) joint: usize,
    /// The place in the loop of the link that it moves, if it lies between two other joints.
    pub(super) place: Option<usize>,
    pub(super) prismatic: bool,
    /// Its numbers as in the text: before, after.
    pub(super) numbers: Vec<String>,
}

/// The constants between joint variables and coordinates.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Coordinates {
    /// Whether each joint of the chain slides.
    pub(super) slides: Vec<bool>,
    /// The numbers of coordinates over joint variables as in the text: factors by rows, then constants.
    pub(super) numbers: Vec<String>,
    /// Those of joint variables over coordinates; none without a redundancy.
    pub(super) back: Vec<String>,
}

/// The construction that the function calls.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Construction {
    SphericalTriple { kinds: Vec<bool>, case: String, polished: bool },
    ThreeParallel { polished: bool },
    ParallelTurns { kinds: Vec<bool>, case: String },
    Position { case: String, polished: bool },
    ThreePrismatic { turning: Vec<usize> },
    TwoSlides { slides: Vec<usize> },
    ShoulderElbowWrist,
    General,
}

/// The text of a module.
#[derive(Clone, Debug)]
pub(super) struct Text {
    pub(super) real: crate::values::enclosure::Float,
    pub(super) dof: usize,
    pub(super) most: usize,
    pub(super) branches: Vec<String>,
    pub(super) prismatic: Vec<bool>,
    pub(super) limits: Vec<String>,
    pub(super) length: String,
    pub(super) loops: Vec<Arrangement>,
    pub(super) construction: Construction,
    pub(super) given: Option<Given>,
    /// The loop of the arm's own joints, if there are virtual joints, which must come out 0.
    pub(super) own: Option<Arrangement>,
    /// The coordinates of coupled joints.
    pub(super) coordinates: Option<Coordinates>,
    /// Whether the function uses the orientation, not only the position.
    pub(super) rotation: bool,
}

/// Code without comments, blanks, and commas before closing brackets; string literals stay unchanged.
fn squeezed(text: &str) -> String {
    let mut all = String::new();
    for line in text.lines() {
        if line.trim_start().starts_with("//") {
            continue;
        }
        let mut quoted = false;
        for c in line.chars() {
            quoted ^= c == '"';
            if quoted || !c.is_whitespace() {
                if matches!(c, ')' | ']' | '}' | '>') && !quoted && all.ends_with(',') {
                    all.pop();
                }
                all.push(c);
            }
        }
    }
    all
}

/// Maximum nesting depth of a constant: two loops of links of rows of entries take six levels.
const DEEPEST: usize = 8;

struct Reader<'a> {
    rest: &'a str,
}

impl<'a> Reader<'a> {
    fn take(&mut self, text: &str) -> bool {
        let rest = self.rest.strip_prefix(text);
        self.rest = rest.unwrap_or(self.rest);
        rest.is_some()
    }

    fn expect(&mut self, text: &str) -> Result<(), String> {
        if self.take(text) {
            return Ok(());
        }
        let found: String = self.rest.chars().take(60).collect();
        Err(format!("`{text}` should stand where there is `{found}`"))
    }

    fn until(&mut self, end: char) -> Result<&'a str, String> {
        let (found, rest) = self.rest.split_once(end).ok_or_else(|| format!("`{end}` is missing"))?;
        self.rest = rest;
        Ok(found)
    }

    fn value(&mut self) -> Result<Value, String> {
        self.value_within(DEEPEST)
    }

    fn value_within(&mut self, depth: usize) -> Result<Value, String> {
        let Some(depth) = depth.checked_sub(1) else { return Err(format!("a value is nested more than {DEEPEST} deep")) };
        if self.take("[") {
            let mut list = Vec::new();
            while !self.take("]") {
                list.push(self.value_within(depth)?);
                self.take(",");
            }
            return Ok(Value::List(list));
        }
        if self.take("\"") {
            return Ok(Value::Word(self.until('"')?.to_owned()));
        }
        let end = self.rest.find([',', ']', ';', '{', '}', ')']).ok_or("a value does not end")?;
        let word = &self.rest[..end];
        self.rest = &self.rest[end..];
        if self.take("{") {
            let mut fields = Vec::new();
            while !self.take("}") {
                let name = self.until(':')?.to_owned();
                fields.push((name, self.value_within(depth)?));
                self.take(",");
            }
            return Ok(Value::Fields(fields));
        }
        let digits = word.strip_prefix('-').unwrap_or(word);
        Ok(match word {
            "" => return Err("a value is missing".into()),
            "true" | "false" => Value::Bool(word == "true"),
            _ if digits.starts_with(|c: char| c.is_ascii_digit()) => Value::Number(word.to_owned()),
            _ => Value::Word(word.to_owned()),
        })
    }

    fn constant(&mut self, name: &str, kind: &str) -> Result<Value, String> {
        self.expect(&format!("const{name}:{kind}="))?;
        let value = self.value()?;
        self.expect(";")?;
        Ok(value)
    }
}

impl Arrangement {
    /// Whether the link at a place is constant: it depends neither on the pose nor on the given joint.
    pub(super) fn is_constant(&self, place: usize) -> bool {
        self.open != place && self.moved != Some(place)
    }
}

impl Value {
    fn list(&self) -> Result<&[Value], String> {
        match self {
            Value::List(list) => Ok(list),
            other => Err(format!("{other:?} is no list")),
        }
    }

    fn bool(&self) -> Result<bool, String> {
        match self {
            Value::Bool(value) => Ok(*value),
            other => Err(format!("{other:?} is neither true nor false")),
        }
    }

    fn count(&self) -> Result<usize, String> {
        match self {
            Value::Number(digits) => digits.parse().map_err(|_| format!("{digits} is no count")),
            other => Err(format!("{other:?} is no count")),
        }
    }

    /// All its numbers and words.
    fn leaves(&self, leaves: &mut Vec<String>) {
        match self {
            Value::Number(text) | Value::Word(text) => leaves.push(text.clone()),
            Value::Bool(value) => leaves.push(value.to_string()),
            Value::List(list) => list.iter().for_each(|value| value.leaves(leaves)),
            Value::Fields(fields) => fields.iter().for_each(|(_, value)| value.leaves(leaves)),
        }
    }
}

fn bools(value: &Value) -> Result<Vec<bool>, String> {
    value.list()?.iter().map(Value::bool).collect()
}

fn counts(value: &Value) -> Result<Vec<usize>, String> {
    value.list()?.iter().map(Value::count).collect()
}

fn arrangement(value: &Value) -> Result<Arrangement, String> {
    const NAMES: [&str; 8] = ["order", "prismatic", "links", "open", "before", "after", "backward", "offsets"];
    let Value::Fields(fields) = value else { return Err("a loop is no `Arrangement`".into()) };
    if !fields.iter().map(|(name, _)| name.trim_start_matches("Arrangement")).eq(NAMES) {
        return Err("a loop has not the fields of `Arrangement`".into());
    }
    let field = |i: usize| &fields[i].1;
    let mut numbers = Vec::new();
    [2, 4, 5, 7].iter().for_each(|i| field(*i).leaves(&mut numbers));
    let found = Arrangement {
        order: counts(field(0))?,
        prismatic: bools(field(1))?,
        open: field(3).count()?,
        backward: field(6).bool()?,
        moved: None,
        numbers,
    };
    let joints = found.order.len();
    let whole = found.prismatic.len() == joints && found.numbers.len() == 14 * joints + 24 && found.open < joints;
    let mut sorted = found.order.clone();
    sorted.sort_unstable();
    if whole && sorted.into_iter().eq(0..joints) {
        Ok(found)
    } else {
        Err("a loop's lists are not as long as it has joints, or its order is none".into())
    }
}

fn given(value: &Value) -> Result<Given, String> {
    let Value::Fields(fields) = value else { return Err("a joint is not `Given`".into()) };
    if !fields.iter().map(|(name, _)| name.as_str()).eq(["joint", "prismatic", "before", "after"]) {
        return Err("a joint has not the fields of `Given`".into());
    }
    let mut numbers = Vec::new();
    fields[2..].iter().for_each(|(_, value)| value.leaves(&mut numbers));
    let found = Given { joint: fields[0].1.count()?, place: None, prismatic: fields[1].1.bool()?, numbers };
    if found.numbers.len() == 24 {
        Ok(found)
    } else {
        Err("the frames of a joint have not twelve numbers each".into())
    }
}

/// The numbers of sums: a square of factors, and constants.
fn sums(reader: &mut Reader<'_>, [factors, offset]: [&str; 2], dof: usize) -> Result<Vec<String>, String> {
    let (mut numbers, mut constants) = (Vec::new(), Vec::new());
    reader.constant(factors, "[[Real;DOF];DOF]")?.leaves(&mut numbers);
    reader.constant(offset, "[Real;DOF]")?.leaves(&mut constants);
    if numbers.len() != dof * dof || constants.len() != dof {
        return Err(format!("{factors} has not as many numbers as it should"));
    }
    numbers.append(&mut constants);
    Ok(numbers)
}

const EXPORT: &str = "#[allow(unused_imports)]pubuseself::all_solutions::{inverse_kinematics,";
const HEAD: &str = "Posture,Postures,Real,Solution,Solutions,Verdict,BRANCHES,DOF,MAX_SOLUTIONS};\
                    #[allow(dead_code,unreachable_pub,clippy::all,clippy::pedantic)]#[rustfmt::skip]modall_solutions{";
const BEGIN: &str = "pubfninverse_kinematics(t:&[[Real;4];4])->Solutions{let[x,y,z,_]=*t;";
const BEGIN_REDUNDANT: &str = "pubfninverse_kinematics(t:&[[Real;4];4],redundancy:Real)->Solutions{let[x,y,z,_]=*t;";
const ROTATION_REDUNDANT: &str = "if!is_pose(t)||!redundancy.is_finite(){returnSolutions::none(Verdict::Invalid);}";
const POSITION_REDUNDANT: &str = "letposition=[x[3],y[3],z[3]];if!all_finite(t)||!redundancy.is_finite()\
                                  {returnSolutions::none(Verdict::Invalid);}";
const VALUE: &str = "letvalue=GIVEN.value(redundancy);";
const FIRST_POSITION: &str = "letposition=transform(&inverse(&GIVEN.link(value)),position);";
const TIP: &str = "lettip=column(&GIVEN.link(value),3);";
const REST: &str = "lett:Frame=GIVEN.rest(value,&[x,y,z]);";
const POSE: &str = "lett:Frame=[x,y,z];";
const LINKS: &str = "letlinks=LOOP.links_at(&t);";
const MOVED_POINT: &str = "letmutlinks=LOOP.links;links[";
const MOVED: &str = "letmutlinks=LOOP.links_at(&t);links[";
const ROTATION: &str = "if!is_pose(t){returnSolutions::none(Verdict::Invalid);}lett:Frame=[x,y,z];";
const POSITION: &str = "letposition=[x[3],y[3],z[3]];if!all_finite(t){returnSolutions::none(Verdict::Invalid);}";
const POLISH: &str = "polish(&mutfound,&Loop{links:&links,prismatic:LOOP.prismatic,target:[0.0;3],length:LENGTH});";
/// The conclusion of closed forms.
const CLOSE: &str =
    "close_where_solutions_meet(&mutfound,&Loop{links:&links,prismatic:LOOP.prismatic,target:[0.0;3],length:LENGTH});";
const POLISH_POSITION: &str =
    "letlinks=[a,b,displaced(from)];polish(&mutfound,&Loop{links:&links,prismatic:LOOP.prismatic,target:to,length:LENGTH});";
const IN_ORDER: &str = "letcount=found.count;forbranchinfound.all.iter_mut().take(count){*branch=LOOP.of_arm(branch);}";

/// What the text of a function depends on.
#[derive(Clone, Copy)]
struct Shape {
    dof: usize,
    given: bool,
    /// The point of a position lies after a given last joint.
    tip: bool,
    own: bool,
    coupled: bool,
    /// The target has a rotation.
    rotation: bool,
}

impl Shape {
    /// The end of the function.
    fn concluded(self, solutions: &str, by_angle: bool) -> String {
        let rotation = if self.rotation { ".of_rotation(&[x,y,z])" } else { "" };
        if self.coupled {
            format!(
                "letjoints:Solutions=conclude({solutions},JOINT_SLIDES,{by_angle}){rotation};\
                 in_coordinates(&joints,COORDINATES,COORDINATE_OFFSET,PRISMATIC)}}"
            )
        } else {
            format!("conclude({solutions},PRISMATIC,{by_angle}){rotation}}}")
        }
    }
}

/// The function after its check of the arguments; also returns the place of the link that a given joint moves.
fn body(reader: &mut Reader<'_>, loops: &[Arrangement], shape: Shape) -> Result<(Construction, Option<usize>), String> {
    let Shape { dof, given, tip, own, .. } = shape;
    let name = |reader: &mut Reader<'_>, end: char| reader.until(end).map(str::to_owned);
    let all = joints_with_given(loops, dof);
    let general = if own {
        "&without_virtual_joints::<6,DOF,16>(&ARM,&general_arm(&LOOPS,&t,LENGTH),&t,LENGTH,GENERAL_ROWS)".into()
    } else if given {
        format!("&GIVEN.with::<6,{all},16>(&general_arm(&LOOPS,&t,LENGTH),value)")
    } else {
        "&general_arm(&LOOPS,&t,LENGTH)".to_owned()
    };
    if reader.take(&shape.concluded(&general, true)) {
        return Ok((Construction::General, None));
    }
    let mut moved = None;
    let point = given && reader.take(MOVED_POINT);
    if point || given && reader.take(MOVED) {
        moved = Some(reader.until(']')?.parse().map_err(|_| "the place of the joint that is given is no number")?);
        reader.expect("=GIVEN.link(value);")?;
    }
    if point {
        let construction = position(reader, loops, (tip, true))?;
        return conclusion(reader, loops, shape, construction).map(|construction| (construction, moved));
    }
    let links = moved.is_some() || reader.take(LINKS);
    let construction = if links && reader.take("letmutfound=spherical_triple(&links,") {
        let kinds = bools(&reader.value()?)?;
        reader.expect(",")?;
        let case = name(reader, ')')?;
        reader.expect(";")?;
        Construction::SphericalTriple { kinds, case, polished: polished(reader, own)? }
    } else if links && reader.take("letmutfound=parallel_turns(&links,") {
        let kinds = bools(&reader.value()?)?;
        reader.expect(",")?;
        let case = name(reader, ')')?;
        reader.expect(";")?;
        Construction::ParallelTurns { kinds, case }
    } else if links && reader.take("letmutfound=three_prismatic(&links,") {
        let turning = counts(&reader.value()?)?;
        reader.expect(");")?;
        if !own {
            reader.expect(CLOSE)?;
        }
        Construction::ThreePrismatic { turning }
    } else if links {
        reader.expect("letmutfound=three_parallel(&links);")?;
        Construction::ThreeParallel { polished: polished(reader, own)? }
    } else if reader.take("letmutfound=shoulder_elbow_wrist(&LOOP,&t,redundancy);") {
        Construction::ShoulderElbowWrist
    } else if reader.take("letmutfound=parallel_turns(&LOOP.links_at(&t),") {
        let kinds = bools(&reader.value()?)?;
        reader.expect(",")?;
        let case = name(reader, ')')?;
        reader.expect(";")?;
        Construction::ParallelTurns { kinds, case }
    } else if reader.take("letmutfound=two_slides(&LOOP.links_at(&t),") {
        let slides = counts(&reader.value()?)?;
        reader.expect(",LENGTH);")?;
        Construction::TwoSlides { slides }
    } else {
        position(reader, loops, (tip, false))?
    };
    conclusion(reader, loops, shape, construction).map(|construction| (construction, moved))
}

/// Whether Newton's method is called for all solutions. Otherwise it handles coincident solutions only, or an arm's `own` joints, refined later.
fn polished(reader: &mut Reader<'_>, own: bool) -> Result<bool, String> {
    let polished = reader.take(POLISH);
    if !polished && !own {
        reader.expect(CLOSE)?;
    }
    Ok(polished)
}

/// A position, from known links or links `moved` by a given joint.
fn position(reader: &mut Reader<'_>, loops: &[Arrangement], (tip, moved): (bool, bool)) -> Result<Construction, String> {
    let end = |frame: &str| if tip { format!("transform(&{frame},tip)") } else { format!("column(&{frame},3)") };
    let points = if loops.first().is_some_and(|way| way.backward) {
        format!("transform(&LOOP.before,position),{});", end("inverse(&LOOP.after)"))
    } else {
        format!("{},transform(&inverse(&LOOP.after),position));", end("LOOP.before"))
    };
    reader.expect(if moved { "let[a,b,_]=links;" } else { "let[a,b,_]=LOOP.links;" })?;
    let polished = reader.take("let(from,to)=(");
    if polished {
        reader.expect(&points)?;
    }
    reader.expect("letmutfound=")?;
    let case = reader.until('(')?.to_owned();
    reader.expect("&a,&b,")?;
    reader.expect(if polished { "from,to);" } else { &points })?;
    if polished {
        reader.expect(POLISH_POSITION)?;
    }
    Ok(Construction::Position { case, polished })
}

/// The number of joints including the given joint; a virtual joint makes it one more than the arm has.
fn joints_with_given(loops: &[Arrangement], dof: usize) -> String {
    match loops.first().map_or(0, |way| way.order.len()) + 1 {
        all if all == dof => "DOF".to_owned(),
        all => all.to_string(),
    }
}

/// The end of the function.
fn conclusion(
    reader: &mut Reader<'_>,
    loops: &[Arrangement],
    shape: Shape,
    construction: Construction,
) -> Result<Construction, String> {
    reader.expect(IN_ORDER)?;
    // Without branches, the conclusion uses the joint variables.
    let by_angle = matches!(construction, Construction::TwoSlides { .. });
    let solutions = if shape.given {
        let others = loops.first().map_or(0, |way| way.order.len());
        let all = joints_with_given(loops, shape.dof);
        let most = if others == 6 { 8 } else { 4 };
        format!("&GIVEN.with::<{others},{all},{most}>(&found,value)")
    } else if shape.own {
        let sizes = if matches!(construction, Construction::ParallelTurns { .. }) { "4,DOF,4" } else { "6,DOF,8" };
        format!("&without_virtual_joints::<{sizes}>(&ARM,&found,&t,LENGTH,ROUNDING)")
    } else {
        "&found".to_owned()
    };
    reader.expect(&shape.concluded(&solutions, by_angle))?;
    Ok(construction)
}

impl Text {
    /// Reads a module; `None` if it states that the arm has no construction. An error describes a place with unexpected text.
    pub(super) fn read(text: &str) -> Result<Option<Text>, String> {
        if text.lines().all(|line| line.is_empty() || line.starts_with("//")) {
            return Ok(None);
        }
        let (mut code, mut blocks) = text.split_once("\n}\n").ok_or("there is no function")?;
        if text.contains("pub fn inverse_kinematics_redundancy(") {
            let more = blocks.split_once("\n}\n").ok_or("there is no second function")?.0.len();
            (code, blocks) = (&text[..code.len() + 3 + more], &blocks[more + 3..]);
        }
        let blocks = taken(blocks)?;
        let real = match (blocks.contains(&"scalar_f64"), blocks.contains(&"scalar_f32")) {
            (true, false) => crate::values::enclosure::Float::F64,
            (false, true) => crate::values::enclosure::Float::F32,
            _ => return Err("there is not one block of the scalar".into()),
        };
        // The closing bracket of the function.
        let code = squeezed(code) + "}";
        let mut reader = Reader { rest: &code };
        reader.expect(EXPORT)?;
        let redundant = reader.take("inverse_kinematics_redundancy,");
        reader.expect(HEAD)?;
        reader.expect("pub")?;
        let dof = reader.constant("DOF", "usize")?.count()?;
        reader.expect("pub")?;
        let most = reader.constant("MAX_SOLUTIONS", "usize")?.count()?;
        reader.expect("pubconstBRANCHES:[&str;")?;
        let number: usize = reader.until(']')?.parse().map_err(|_| "BRANCHES has no length")?;
        reader.expect("=")?;
        let mut branches = Vec::new();
        reader.value()?.leaves(&mut branches);
        reader.expect(";")?;
        let prismatic = bools(&reader.constant("PRISMATIC", "[bool;DOF]")?)?;
        let mut limits = Vec::new();
        reader.constant("POSITION_LIMITS", "[[Real;2];DOF]")?.leaves(&mut limits);
        let mut length = Vec::new();
        reader.constant("LENGTH", "Real")?.leaves(&mut length);
        let mut loops = if reader.take("constLOOPS:[Arrangement<6>;2]=") {
            let ways = reader.value()?;
            ways.list()?.iter().map(arrangement).collect::<Result<Vec<_>, String>>()?
        } else {
            reader.expect("constLOOP:Arrangement<")?;
            let joints = reader.until('>')?.to_owned();
            reader.expect("=")?;
            let way = arrangement(&reader.value()?)?;
            if way.order.len().to_string() != joints {
                return Err("LOOP has not as many joints as it says".into());
            }
            vec![way]
        };
        reader.expect(";")?;
        let mut own = None;
        if !redundant && reader.take("constARM:Arrangement<6>=") {
            own = Some(arrangement(&reader.value()?)?);
            reader.expect(";")?;
        }
        let mut joint = None;
        if redundant && reader.take("constGIVEN:Given=Given") {
            joint = Some(given(&reader.value()?)?);
            reader.expect(";")?;
        }
        let coordinates = if reader.rest.starts_with("constJOINT_SLIDES") {
            let slides = bools(&reader.constant("JOINT_SLIDES", "[bool;DOF]")?)?;
            let numbers = sums(&mut reader, ["COORDINATES", "COORDINATE_OFFSET"], dof)?;
            let back = if redundant { sums(&mut reader, ["COUPLING", "COUPLING_OFFSET"], dof)? } else { Vec::new() };
            Some(Coordinates { slides, numbers, back })
        } else {
            None
        };
        reader.expect(if redundant { BEGIN_REDUNDANT } else { BEGIN })?;
        let rotation = reader.take(if redundant { ROTATION_REDUNDANT } else { ROTATION });
        if !rotation {
            reader.expect(if redundant { POSITION_REDUNDANT } else { POSITION })?;
        }
        // Whether the given joint is at an end of the arm.
        let (mut at_end, mut tip) = (false, false);
        if redundant {
            if let Some(joint) = &joint {
                reader.expect(VALUE)?;
                at_end = match (rotation, joint.joint) {
                    (true, _) => reader.take(REST),
                    (false, 0) => reader.take(FIRST_POSITION),
                    (false, _) => reader.take(TIP),
                };
                tip = at_end && !rotation && joint.joint > 0;
            }
            if !at_end && rotation {
                reader.expect(POSE)?;
            }
        }
        let (given, coupled) = (joint.is_some(), coordinates.is_some());
        let shape = Shape { dof, given, tip, own: own.is_some(), coupled, rotation };
        let (construction, moved) = body(&mut reader, &loops, shape)?;
        let first = loops.first_mut().ok_or("there is no loop")?;
        if moved.is_some_and(|place| place >= first.order.len() || place == first.open) {
            return Err("the place of the joint that is given is none".into());
        }
        first.moved = moved;
        if let Some(joint) = &mut joint {
            joint.place = moved;
            // For a direction, the virtual rotation follows a last joint.
            let last = joint.joint + 1 == dof;
            let end = joint.joint == 0 || last && (at_end || dof != 6 || first.order.len() != 6);
            if joint.joint >= dof || end != at_end || end == moved.is_some() {
                return Err("GIVEN: the function takes the joint from another place of the arm".into());
            }
        }
        if rotation == matches!(construction, Construction::Position { .. }) {
            return Err("what is read of the pose is not what the construction asks for".into());
        }
        if redundant {
            let (read, swivel, name) = match coupled {
                true => ("letvariables=sums_of(q,COUPLING,COUPLING_OFFSET);", "&variables", "variables"),
                false => ("", "q", "q"),
            };
            let value =
                joint.as_ref().map_or(format!("swivel_angle(&LOOP,{swivel})"), |joint| format!("{name}[{}]", joint.joint));
            reader.expect(&format!("pubfninverse_kinematics_redundancy(q:&[Real;DOF])->Real{{{read}{value}}}"))?;
        }
        if (construction == Construction::ShoulderElbowWrist) != (redundant && joint.is_none()) {
            return Err("what is given is not what the construction asks for".into());
        }
        // Its six places are the arm's joints, followed by virtual joints that stay at 0.
        if own
            .as_ref()
            .is_some_and(|way| way.order != [0, 1, 2, 3, 4, 5] || way.backward || way.open != 5 || dof >= 6 || !rotation)
        {
            return Err("ARM: it is not the loop of the arm's own joints, from the base on".into());
        }
        if !reader.rest.is_empty() {
            return Err("something stands behind the function".into());
        }
        let whole = branches.len() == number && prismatic.len() == dof && limits.len() == 2 * dof && length.len() == 1;
        let whole = whole && coordinates.as_ref().is_none_or(|of| of.slides.len() == dof);
        let loops_fit = match construction {
            Construction::General => loops.len() == 2 && loops.iter().all(|way| way.order.len() == 6),
            _ => loops.len() == 1 && loops[0].order.len() + usize::from(joint.is_some()) >= dof,
        };
        if !(whole && loops_fit) {
            return Err("the lists of constants have not the lengths that they should".into());
        }
        Ok(Some(Text {
            real,
            dof,
            most,
            branches,
            prismatic,
            limits,
            length: length.remove(0),
            loops,
            construction,
            given: joint,
            own,
            coordinates,
            rotation,
        }))
    }
}

/// The names of the blocks in a text; each must equal the block here, and nothing else may occur.
fn taken(text: &str) -> Result<Vec<&'static str>, String> {
    let mut rest = text;
    let mut names = Vec::new();
    for block in TEXTS {
        if let Some(behind) = rest.strip_prefix('\n').and_then(|rest| rest.strip_prefix(block.source)) {
            rest = behind;
            names.push(block.name);
        }
    }
    if rest != "}\n" {
        let differs = |block: &&armgen_inverse_kinematics::texts::Text| {
            let first = block.source.lines().next().unwrap_or("");
            rest.trim_start_matches('\n').starts_with(first)
        };
        return Err(match TEXTS.iter().find(differs) {
            Some(block) => {
                let same = block.source.lines().zip(rest.trim_start_matches('\n').lines()).take_while(|(x, y)| x == y).count();
                format!("building block `{}` is not the tested one, from its line {} on", block.name, same + 1)
            }
            None => "what stands there is no building block".into(),
        });
    }
    for block in TEXTS.iter().filter(|block| names.contains(&block.name)) {
        if let Some(need) = block.needs.iter().find(|need| !names.contains(*need)) {
            return Err(format!("building block `{}` needs `{need}`", block.name));
        }
    }
    Ok(names)
}
