//! Small changes of a module's text at a single place.

use syn::{BinOp, Expr, File, Item, Lit, Stmt, UnOp};

/// Kinds of change.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// + for -, - for +, or an added or removed minus sign before an operand.
    Sign,
    /// A digit of a literal.
    Digit,
    /// Swapped operands of a difference or a quotient.
    Swapped,
    /// An operand in place of another.
    Operand,
    /// An omitted term or factor.
    Dropped,
}

/// A change: its place and its kind.
#[derive(Clone, Debug)]
pub(crate) struct Change {
    /// Function or constant.
    pub(crate) name: String,
    /// Its kind.
    pub(crate) kind: Kind,
    /// Before and after, for printing.
    #[allow(dead_code)]
    pub(crate) what: String,
}

/// A traversal of all expressions that changes a selected one.
struct Walk<'a> {
    /// Number of places before the change; the change happens at 0.
    left: usize,
    choice: u64,
    /// Whether numbers are f32.
    single: bool,
    names: &'a [Expr],
    done: Option<(Kind, String)>,
    /// Whether changes happen in this function.
    counting: bool,
    places: usize,
}

fn text(tokens: &impl quote::ToTokens) -> String {
    tokens.to_token_stream().to_string()
}

fn parenthesised(expression: &Expr) -> Expr {
    match expression {
        Expr::Binary(_) => syn::parse_quote!((#expression)),
        other => other.clone(),
    }
}

impl Walk<'_> {
    /// Whether the change happens at this place.
    fn turn(&mut self) -> bool {
        if self.counting {
            self.places += 1;
            return false;
        }
        if self.done.is_some() {
            return false;
        }
        if self.left == 0 {
            return true;
        }
        self.left -= 1;
        false
    }

    fn replace(&mut self, place: &mut Expr, kind: Kind, by: Expr) {
        self.done = Some((kind, format!("{} -> {}", text(place), text(&by))));
        *place = by;
    }

    fn expression(&mut self, e: &mut Expr) {
        match e {
            Expr::Paren(inner) => self.expression(&mut inner.expr),
            Expr::Array(array) => array.elems.iter_mut().for_each(|e| self.expression(e)),
            Expr::Tuple(tuple) => tuple.elems.iter_mut().for_each(|e| self.expression(e)),
            Expr::Struct(structure) => structure.fields.iter_mut().for_each(|field| self.expression(&mut field.expr)),
            Expr::Call(call) => call.args.iter_mut().for_each(|e| self.expression(e)),
            Expr::Unary(unary) if matches!(unary.op, UnOp::Neg(_)) => {
                self.expression(&mut unary.expr);
                if self.turn() {
                    let inner = (*unary.expr).clone();
                    self.replace(e, Kind::Sign, inner);
                }
            }
            Expr::Binary(binary) => {
                self.expression(&mut binary.left);
                self.expression(&mut binary.right);
                // Separate places for the sign, the order, and a term or factor.
                if self.turn() {
                    let mut other = binary.clone();
                    other.op = match binary.op {
                        BinOp::Add(_) => syn::parse_quote!(-),
                        BinOp::Sub(_) => syn::parse_quote!(+),
                        _ => {
                            let left = parenthesised(&binary.left);
                            other.left = syn::parse_quote!((-#left));
                            binary.op
                        }
                    };
                    self.replace(e, Kind::Sign, Expr::Binary(other));
                    return;
                }
                if matches!(binary.op, BinOp::Sub(_) | BinOp::Div(_)) && self.turn() {
                    let (a, b, op) = (parenthesised(&binary.left), parenthesised(&binary.right), binary.op);
                    self.replace(e, Kind::Swapped, syn::parse_quote!(#b #op #a));
                    return;
                }
                if self.turn() {
                    let kept = if self.choice & 1 == 0 { &binary.left } else { &binary.right };
                    let kept = parenthesised(kept);
                    self.replace(e, Kind::Dropped, kept);
                }
            }
            Expr::Lit(literal) => {
                let Lit::Float(float) = &literal.lit else { return };
                if self.turn() {
                    let digits = float.base10_digits().to_string();
                    let at: Vec<usize> = digits.bytes().enumerate().filter(|(_, b)| b.is_ascii_digit()).map(|(i, _)| i).collect();
                    let at = at[(self.choice % at.len() as u64) as usize];
                    let digit = u64::from(digits.as_bytes()[at] - b'0');
                    let other = (digit + 1 + (self.choice >> 8) % 9) % 10;
                    let changed = format!("{}{other}{}", &digits[..at], &digits[at + 1..]);
                    // Written as the shortest decimal of its float, the only form of literals in a module.
                    let changed = match self.single {
                        true => format!("{:?}", changed.parse::<f32>().expect("a decimal number")),
                        false => format!("{:?}", changed.parse::<f64>().expect("a decimal number")),
                    };
                    let changed: syn::LitFloat = syn::parse_str(&changed).expect("still a decimal number");
                    self.replace(e, Kind::Digit, syn::parse_quote!(#changed));
                }
            }
            Expr::Path(_) | Expr::Index(_) if self.turn() => {
                let own = text(e);
                let others: Vec<&Expr> = self.names.iter().filter(|n| text(*n) != own).collect();
                if others.is_empty() {
                    return;
                }
                let other = others[(self.choice % others.len() as u64) as usize].clone();
                self.replace(e, Kind::Operand, other);
            }
            _ => {}
        }
    }
}

/// Operands available before each line of a function: names and entries of arguments that occur in it.
fn operands(block: &syn::Block, up_to: usize) -> Vec<Expr> {
    let mut names: Vec<Expr> = Vec::new();
    for statement in &block.stmts[..up_to] {
        let Stmt::Local(local) = statement else { continue };
        let mut pattern = |p: &syn::Pat| {
            if let syn::Pat::Ident(name) = p {
                let name = &name.ident;
                names.push(syn::parse_quote!(#name));
            }
        };
        match &local.pat {
            syn::Pat::Tuple(tuple) => tuple.elems.iter().for_each(&mut pattern),
            p => pattern(p),
        }
    }
    names
}

/// Entries such as `q[3]` that occur in a function.
fn entries(function: &syn::ItemFn) -> Vec<Expr> {
    let tokens = text(&function.block);
    let mut found: Vec<Expr> = Vec::new();
    for argument in ["pi", "q", "dq", "ddq", "dqr", "ddqr", "tau"] {
        for index in 0..100 {
            let entry = format!("{argument} [{index}]");
            // The word must not be the end of a longer word.
            let whole = tokens.match_indices(&entry).any(|(at, _)| !tokens[..at].ends_with(|c: char| c.is_alphanumeric()));
            if whole {
                found.push(syn::parse_str(&entry).expect("an entry"));
            }
        }
    }
    found
}

/// Whether a function belongs to the module's purpose: public, or the writer of a public function's result. Functions over parameters are
/// compared word for word.
fn is_of_the_module(function: &syn::ItemFn) -> bool {
    let name = function.sig.ident.to_string();
    let public = matches!(function.vis, syn::Visibility::Public(_)) && !name.contains("parameter");
    public || name.ends_with("_into")
}

/// A module that can be changed at its places.
pub(crate) struct Mutable {
    file: File,
    single: bool,
    /// Entries of arguments that occur in each item.
    entries: Vec<Vec<Expr>>,
}

impl Mutable {
    pub(crate) fn new(source: &str) -> Mutable {
        let file = syn::parse_file(source).expect("the module is Rust");
        let entries = file.items.iter().map(|item| match item {
            Item::Fn(function) => entries(function),
            _ => Vec::new(),
        });
        Mutable { entries: entries.collect(), single: source.contains("type Real = f32"), file }
    }

    fn walk(item: &mut Item, entries: &[Expr], walk: &mut Walk<'_>) -> Option<String> {
        match item {
            Item::Fn(function) if is_of_the_module(function) => {
                for line in 0..function.block.stmts.len() {
                    let names = if walk.counting { Vec::new() } else { operands(&function.block, line) };
                    let names = [names.as_slice(), entries].concat();
                    let mut inner = Walk { names: &names, done: walk.done.take(), ..*walk };
                    match &mut function.block.stmts[line] {
                        // `let _ = dq;` has no effect.
                        Stmt::Local(local) if !matches!(local.pat, syn::Pat::Wild(_)) => {
                            if let Some(init) = &mut local.init {
                                inner.expression(&mut init.expr);
                            }
                        }
                        // An entry written into memory of the caller.
                        Stmt::Expr(Expr::Assign(assigned), _) => inner.expression(&mut assigned.right),
                        Stmt::Expr(e, _) => inner.expression(e),
                        _ => {}
                    }
                    (walk.left, walk.places, walk.done) = (inner.left, inner.places, inner.done.take());
                    if walk.done.is_some() {
                        // A function that writes into memory of the caller is read as the function that returns the same result.
                        let name = function.sig.ident.to_string();
                        return Some(name.strip_suffix("_into").unwrap_or(&name).to_owned());
                    }
                }
                None
            }
            Item::Const(constant) if !matches!(&*constant.expr, Expr::Lit(_)) => {
                walk.expression(&mut constant.expr);
                walk.done.is_some().then(|| constant.ident.to_string())
            }
            _ => None,
        }
    }

    /// Indices of the items with places, with the number of places.
    pub(crate) fn places(&self) -> Vec<(usize, usize)> {
        (0..self.file.items.len())
            .map(|item| {
                let mut walk =
                    Walk { left: 0, choice: 0, single: self.single, names: &[], done: None, counting: true, places: 0 };
                Mutable::walk(&mut self.file.items[item].clone(), &[], &mut walk);
                (item, walk.places)
            })
            .filter(|(_, places)| *places > 0)
            .collect()
    }

    /// The text changed at a place of an item, if a change is possible there.
    pub(crate) fn change(&self, item: usize, place: usize, choice: u64) -> Option<(String, Change)> {
        let mut file = self.file.clone();
        let mut walk = Walk { left: place, choice, single: self.single, names: &[], done: None, counting: false, places: 0 };
        let name = Mutable::walk(&mut file.items[item], &self.entries[item], &mut walk)?;
        let (kind, what) = walk.done?;
        Some((prettyplease::unparse(&file), Change { name, kind, what }))
    }
}
