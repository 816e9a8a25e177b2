//! Expressions of a quantity's entries in a pool, and the closed form, which is another derivation of the same.
//!
//! A quantity may have several derivations, each in a pool of its own: a recursion over the links and, where it stays short, the closed
//! form. All give the same expressions, which their fingerprints prove; which one is emitted is a matter of cost alone.

use crate::ring::normal_form::{Arrangement, NormalForm};
use crate::ring::{ExprId, Pool, Symbol};

/// A derivation by writing out every entry.
const CLOSED_FORM: &str = "closed form";
/// A derivation by a recursion over the links.
pub(crate) const OVER_THE_LINKS: &str = "recursion over the links";
/// The same with bodies that move alike taken together.
pub(crate) const OVER_GROUPED_BODIES: &str = "recursion over grouped bodies";

/// The ways in which the functions of a module are derived, in a few words.
pub const METHODS: [&str; 3] = [CLOSED_FORM, OVER_THE_LINKS, OVER_GROUPED_BODIES];

/// One derivation of a quantity: its entries, row by row, in a pool.
#[derive(Clone)]
pub struct Derivation {
    /// The expressions.
    pub pool: Pool,
    /// Entries, row by row.
    pub entries: Vec<ExprId>,
    /// How it was derived, in a few words.
    pub method: &'static str,
    /// For each joint the one before it whose axis is parallel to its own, and whether it points the other way.
    pub parallel: Vec<Option<(u16, bool)>>,
}

/// Most terms of an entry, intermediate forms included, up to which a closed form is tried.
pub const CLOSED_FORM_TERMS: usize = 300;

impl Derivation {
    /// The closed form of every entry, if none is too long.
    pub fn closed_forms(&self) -> Option<Vec<NormalForm>> {
        self.pool.all_normal_forms(&self.entries, CLOSED_FORM_TERMS)
    }

    /// The same without the variables that no entry depends on; `None` where there are no such variables.
    pub fn without_cancelled_variables(&self) -> Option<Derivation> {
        let (all, joints) = self.pool.with_gravity(&self.entries);
        let (mut pool, mut entries) = self.pool.without_cancelled_variables(&all)?;
        pool.take_gravity(&mut entries, &joints);
        Some(Derivation { pool, entries, ..self.clone() })
    }

    /// The derivations from the closed form, if it exists: one for each order of its products, and the same in the rates of links
    /// about parallel axes.
    pub fn by_closed_form(&self) -> Vec<Derivation> {
        let (all, joints) = self.pool.with_gravity(&self.entries);
        let Some(forms) = self.pool.all_normal_forms(&all, CLOSED_FORM_TERMS) else { return Vec::new() };
        let derivation = |forms: &[NormalForm], arrangement, meaning: &mut dyn FnMut(&mut Pool, Symbol) -> ExprId| {
            let mut pool = Pool::new(self.pool.field().clone());
            let mut entries = forms.iter().map(|form| pool.from_normal_form_in(form, arrangement, meaning)).collect();
            pool.take_gravity(&mut entries, &joints);
            Derivation { pool, entries, method: CLOSED_FORM, parallel: self.parallel.clone() }
        };
        let mut all: Vec<Derivation> = Arrangement::ALL
            .iter()
            .map(|&arrangement| derivation(&forms, arrangement, &mut |pool, symbol| pool.symbol(symbol)))
            .collect();
        if let Some(forms) = self.forms_in_absolute_rates(&forms) {
            all.extend(
                Arrangement::ALL
                    .iter()
                    .map(|&arrangement| derivation(&forms, arrangement, &mut |pool, symbol| self.absolute(pool, symbol))),
            );
        }
        all
    }

    /// The closed forms in absolute rates: w_i is the rate of link i about the axis that it shares with links before it, and
    /// dq_i = ±(w_i - w_p). Accelerations likewise. Squares of sums of rates then stay squares.
    fn forms_in_absolute_rates(&self, forms: &[NormalForm]) -> Option<Vec<NormalForm>> {
        if self.parallel.iter().all(Option::is_none) {
            return None;
        }
        let rewritten = |of: &Pool, exprs: &[ExprId]| {
            let mut pool = Pool::new(of.field().clone());
            let entries = of.rewritten(exprs, &mut pool, &mut |pool, symbol| {
                let own = pool.symbol(symbol);
                let Some((rate, (before, opposite))) = moving(symbol).zip(self.before(symbol)) else {
                    return own;
                };
                let before = pool.symbol(rate(before));
                pool.sub(own, before).signed(opposite)
            });
            (entries != exprs || pool.len() != of.len()).then(|| pool.all_normal_forms(&entries, CLOSED_FORM_TERMS))?
        };
        let (all, _) = self.pool.with_gravity(&self.entries);
        // What cancels in a closed form is gone there; a recursion over coupled joints has long sums of it.
        rewritten(&self.pool, &all).or_else(|| {
            let mut pool = Pool::new(self.pool.field().clone());
            let mut written = |form| pool.from_normal_form_in(form, Arrangement::ALL[0], &mut |pool, symbol| pool.symbol(symbol));
            let entries: Vec<ExprId> = forms.iter().map(&mut written).collect();
            rewritten(&pool, &entries)
        })
    }

    /// The joint before the symbol's own whose axis is parallel, and whether it points the other way.
    fn before(&self, symbol: Symbol) -> Option<(u16, bool)> {
        self.parallel.get(usize::from(symbol.index())).copied().flatten()
    }

    /// The rate (or acceleration) of a link about the axis that it shares with links before it: w_i = w_p ± dq_i.
    fn absolute(&self, pool: &mut Pool, symbol: Symbol) -> ExprId {
        let own = pool.symbol(symbol);
        let Some((rate, (before, opposite))) = moving(symbol).zip(self.before(symbol)) else { return own };
        let before = self.absolute(pool, rate(before));
        pool.add(before, own.signed(opposite))
    }
}

/// The constructor of the symbol, if it is a rate or an acceleration.
fn moving(symbol: Symbol) -> Option<fn(u16) -> Symbol> {
    match symbol {
        Symbol::Rate(_) => Some(Symbol::Rate),
        Symbol::Acceleration(_) => Some(Symbol::Acceleration),
        Symbol::ReferenceRate(_) => Some(Symbol::ReferenceRate),
        Symbol::ReferenceAcceleration(_) => Some(Symbol::ReferenceAcceleration),
        _ => None,
    }
}
