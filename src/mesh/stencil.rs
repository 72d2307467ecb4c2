//! The cells around one point of a Freudenthal lattice, computed once for each dimension.
//!
//! Axes are bits, and a set of axes is a step along all of them. A cell of dimension k is a point, its *anchor*, and a
//! chain of sets of axes {} = S0 < S1 < ... < Sk: its vertices are the anchor after each of the steps. The chain is the
//! *type* of the cell.

use std::sync::LazyLock;

/// Steps S1 to Sk from the anchor, padded with 0.
pub(super) type Chain = [u8; 3];

/// By dimension: the chains in the order of cell numbers.
type Chains = [Vec<Chain>; 4];

/// Most types of cells of one dimension.
const KINDS: usize = 12;

/// Cells beside another one, by all chains, its dimension and its own chain.
type Beside<'a> = &'a dyn Fn(&Chains, usize, Chain) -> Vec<Place>;

/// A cell beside another one, or at a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Place {
    /// Dimension of the cell.
    pub dimension: u8,
    /// Type of the cell.
    pub kind: u8,
    /// Steps back to its anchor.
    pub back: u8,
    /// Steps forward to its anchor.
    pub forward: u8,
    /// Rims on which the place is empty: bit `a` for the first point of axis `a`, bit `3 + a` for the last.
    pub not_at: u8,
}

/// A few places, in an array rather than a list: what looks up millions of cells waits for one address only.
#[derive(Debug, Clone, Copy)]
pub(super) struct Places {
    count: u8,
    list: [Place; 14],
}

impl Places {
    fn new(places: &[Place]) -> Self {
        let mut list = [Place { dimension: 0, kind: 0, back: 0, forward: 0, not_at: 0 }; 14];
        list[..places.len()].copy_from_slice(places);
        Self { count: places.len() as u8, list }
    }
}

impl std::ops::Deref for Places {
    type Target = [Place];

    fn deref(&self) -> &[Place] {
        &self.list[..self.count as usize]
    }
}

/// Cells and incidences of one dimension of lattice, by dimension and type of the cell.
#[derive(Debug)]
pub(super) struct Stencil {
    /// The types.
    pub chains: [[Chain; KINDS]; 4],
    /// The facets, without the last vertex first.
    pub facets: [[Places; KINDS]; 4],
    /// The cofacets, lowest number first.
    pub cofacets: [[Places; KINDS]; 4],
    /// All cells with a point, by dimension, lowest number first.
    pub star: Vec<Place>,
}

/// The stencil of lattices of dimension 1, 2 or 3.
pub(super) fn stencil(dimension: usize) -> &'static Stencil {
    static STENCILS: LazyLock<[Stencil; 3]> = LazyLock::new(|| [1, 2, 3].map(Stencil::new));
    &STENCILS[dimension - 1]
}

impl Stencil {
    fn new(dimension: usize) -> Self {
        let chains = chains(dimension);
        let of_all = |list: Beside| {
            [0, 1, 2, 3].map(|k: usize| {
                let mut of_kinds = [Places::new(&[]); KINDS];
                for (places, &chain) in of_kinds.iter_mut().zip(&chains[k]) {
                    *places = Places::new(&list(&chains, k, chain));
                }
                of_kinds
            })
        };
        let facets = of_all(&facets);
        let cofacets = of_all(&|chains, k, chain| cofacets(chains, k, chain, (1 << dimension) - 1));
        let star = star(&chains);
        let padded = |list: &Vec<Chain>| {
            let mut chains = [[0; 3]; KINDS];
            chains[..list.len()].copy_from_slice(list);
            chains
        };
        Self { chains: [0, 1, 2, 3].map(|k: usize| padded(&chains[k])), facets, cofacets, star }
    }
}

/// Chains in lexicographic order; those of tetrahedra as [`Grid`](super::Grid) lists the tetrahedra of a cube.
fn chains(dimension: usize) -> Chains {
    let steps = 1u8..1 << dimension;
    let mut chains = [vec![[0; 3]], Vec::new(), Vec::new(), Vec::new()];
    for a in steps.clone() {
        chains[1].push([a, 0, 0]);
        for b in steps.clone().filter(|&b| b != a && a & b == a) {
            chains[2].push([a, b, 0]);
        }
    }
    if dimension == 3 {
        chains[3] = vec![[1, 3, 7], [2, 6, 7], [4, 5, 7], [1, 5, 7], [2, 3, 7], [4, 6, 7]];
    }
    chains
}

fn kind(chains: &Chains, dimension: usize, chain: Chain) -> u8 {
    chains[dimension].iter().position(|&other| other == chain).unwrap_or_default() as u8
}

fn facets(chains: &Chains, k: usize, chain: Chain) -> Vec<Place> {
    if k == 0 {
        return Vec::new();
    }
    let facet = |omitted: usize| {
        // Without the anchor, the first step leads to the new one.
        let forward = if omitted == 0 { chain[0] } else { 0 };
        let mut rest = [0; 3];
        let kept = (1..=k).filter(|&place| place != omitted.max(1)).map(|place| chain[place - 1] & !forward);
        for (slot, step) in rest.iter_mut().zip(kept) {
            *slot = step;
        }
        Place { dimension: k as u8 - 1, kind: kind(chains, k - 1, rest), back: 0, forward, not_at: 0 }
    };
    (0..=k).rev().map(facet).collect()
}

fn cofacets(chains: &Chains, k: usize, chain: Chain, all: u8) -> Vec<Place> {
    if k == 3 || chains[k + 1].is_empty() {
        return Vec::new();
    }
    let top = if k == 0 { 0 } else { chain[k - 1] };
    let dimension = k as u8 + 1;
    let mut places = Vec::new();
    for back in (1..=all).rev().filter(|back| back & top == 0) {
        let mut longer = [back, 0, 0];
        for place in 0..k {
            longer[place + 1] = chain[place] | back;
        }
        places.push(Place { dimension, kind: kind(chains, k + 1, longer), back, forward: 0, not_at: back });
    }
    // With the anchor kept, one more step somewhere after it: the cofacets are the chains that hold this one.
    for (number, longer) in chains[k + 1].iter().enumerate() {
        if chain[..k].iter().all(|step| longer[..=k].contains(step)) {
            places.push(Place { dimension, kind: number as u8, back: 0, forward: 0, not_at: (longer[k] & !top) << 3 });
        }
    }
    places
}

fn star(chains: &Chains) -> Vec<Place> {
    let mut star = Vec::new();
    for (k, chains) in chains.iter().enumerate() {
        let mut cells = Vec::new();
        for (number, chain) in chains.iter().enumerate() {
            let top = if k == 0 { 0 } else { chain[k - 1] };
            for back in std::iter::once(0).chain(chain[..k].iter().copied()) {
                let not_at = back | (top & !back) << 3;
                cells.push(Place { dimension: k as u8, kind: number as u8, back, forward: 0, not_at });
            }
        }
        // The further back the anchor, the lower the number.
        cells.sort_by_key(|place| (std::cmp::Reverse(place.back), place.kind));
        star.extend(cells);
    }
    star
}
