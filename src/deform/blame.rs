//! From a proof that cones contradict each other to the elements and handles that are to blame.

use super::{HeldVertices, RestShape};
use crate::qp::Certificate;

/// Elements whose multiplier is below this share of the largest are not named.
const NAMED: f64 = 1e-2;

/// Why no shape without inversions has the asked rotations and handles.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Blame {
    /// Elements that cannot all keep their orientation, the most loaded first.
    pub elements: Vec<usize>,
    /// The positive multiplier of each of these in the proof, or by how much its cone had to be relaxed; the largest is 1.
    pub loads: Vec<f64>,
    /// Handles nearest to these elements along the mesh, nearest first, by their places in the list of names; two where there are two.
    pub handles: Vec<usize>,
    /// Their names.
    pub names: Vec<String>,
    /// Whether held vertices take part in the contradiction: only hard handles can. Otherwise the rotations alone contradict each other.
    pub is_of_handles: bool,
    /// The proof is exact, not a bound that is thousands of times the energy found.
    pub is_exact: bool,
}

impl Blame {
    /// Names the elements of a certificate and the handles around them.
    pub(super) fn new(certificate: &Certificate, rest: &RestShape, held: &HeldVertices, is_hard: bool) -> Self {
        // Relaxations are few where the ray spreads over many.
        let loaded = if certificate.relaxations.is_empty() {
            certificate.constraints.iter().copied().zip(certificate.multipliers.iter().copied()).collect()
        } else {
            certificate.relaxations.clone()
        };
        let blame = Self::of_elements(loaded, rest, held);
        Self { is_of_handles: is_hard, is_exact: certificate.least_objective.is_none(), ..blame }
    }

    /// Sorts loaded elements and names the handles around them; no proof.
    pub(super) fn of_elements(mut loaded: Vec<(usize, f64)>, rest: &RestShape, held: &HeldVertices) -> Self {
        let most = loaded.iter().map(|&(_, load)| load).fold(f64::MIN_POSITIVE, f64::max);
        loaded.retain(|&(_, load)| load >= NAMED * most);
        loaded.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        let elements: Vec<usize> = loaded.iter().map(|&(element, _)| element).collect();
        let handles = nearest_handles(rest, held, &elements);
        Self {
            names: handles.iter().map(|&handle| held.names[handle].clone()).collect(),
            handles,
            loads: loaded.iter().map(|&(_, load)| load / most).collect(),
            elements,
            is_of_handles: false,
            is_exact: false,
        }
    }
}

impl std::fmt::Display for Blame {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let listed: Vec<String> = self.elements.iter().take(5).map(usize::to_string).collect();
        let (noun, more) = match self.elements.len() {
            1 => ("element", String::new()),
            count if count > 5 => ("elements", format!(" and {} more", count - 5)),
            _ => ("elements", String::new()),
        };
        let what = if self.is_of_handles { "the places and rotations" } else { "the rotations" };
        let names: Vec<String> = self.names.iter().map(|name| format!("\"{name}\"")).collect();
        match names.as_slice() {
            [one, other, ..] => write!(f, "{what} of the handles {one} and {other} contradict each other")?,
            [one] => write!(f, "{what} about the handle {one} contradict each other")?,
            [] => write!(f, "{what} of the elements contradict each other")?,
        }
        write!(f, ": {noun} {}{more} cannot keep from inverting", listed.join(", "))
    }
}

/// At most two handles, nearest to some elements in steps from vertex to vertex of an element; ties by place.
fn nearest_handles(rest: &RestShape, held: &HeldVertices, elements: &[usize]) -> Vec<usize> {
    let n = rest.vertex_count();
    let mut owner = vec![u32::MAX; n];
    for (vertex, &handle) in held.vertices.iter().zip(&held.owners) {
        owner[vertex.index()] = handle as u32;
    }
    let mut starts = vec![0u32; n + 1];
    for element in 0..rest.element_count() {
        rest.corners(element).iter().for_each(|&vertex| starts[vertex as usize + 1] += 1);
    }
    for vertex in 0..n {
        starts[vertex + 1] += starts[vertex];
    }
    let mut next = starts.clone();
    let mut around = vec![0u32; starts[n] as usize];
    for element in 0..rest.element_count() {
        for &vertex in rest.corners(element) {
            around[next[vertex as usize] as usize] = element as u32;
            next[vertex as usize] += 1;
        }
    }
    let mut is_seen = vec![false; n];
    let mut layer: Vec<u32> = Vec::new();
    for &vertex in elements.iter().flat_map(|&element| rest.corners(element)) {
        if !std::mem::replace(&mut is_seen[vertex as usize], true) {
            layer.push(vertex);
        }
    }
    let mut found: Vec<usize> = Vec::new();
    while !layer.is_empty() && found.len() < 2 {
        let mut here: Vec<usize> =
            layer.iter().map(|&vertex| owner[vertex as usize]).filter(|&handle| handle != u32::MAX).map(|handle| handle as usize).collect();
        here.sort_unstable();
        here.dedup();
        found.extend(here.into_iter().filter(|handle| !found.contains(handle)).collect::<Vec<_>>());
        let mut beyond = Vec::new();
        for &vertex in &layer {
            for &element in &around[starts[vertex as usize] as usize..starts[vertex as usize + 1] as usize] {
                for &other in rest.corners(element as usize) {
                    if !std::mem::replace(&mut is_seen[other as usize], true) {
                        beyond.push(other);
                    }
                }
            }
        }
        layer = beyond;
    }
    found.truncate(2);
    found
}
