//! Plateaus: given values that are equal and joined by edges are one place, and so are the parts that nothing else reaches.
//!
//! A handle of several vertices holds them all at one value. None of them lies above all its neighbours, so the words minimum and
//! maximum are about the graph in which every connected set of given, equal values is one node. Representative function,
//! monotonicity edges, levels and repair live on that graph; the energy lives on the mesh.
//!
//! A part of the mesh behind such a plateau, which no other value reaches, can only be constant under the maximum principle: any
//! other function has an extremum there. It becomes part of the plateau.

use crate::field::VertexId;
use crate::mesh::{MeshError, SimplicialComplex};
use crate::monotone::unreachable_regions;
use crate::morse::WantedExtrema;

use super::InterpolateError;

const NONE: u32 = u32::MAX;

/// Below this part of the range, a difference of harmonic values beside a given value says nothing.
const NOISE: f64 = 1e-12;

/// A mesh whose plateaus of given values are one node each.
pub(super) struct Contraction {
    /// The nodes and the edges between them.
    pub graph: SimplicialComplex,
    /// Node of each vertex.
    pub node: Vec<u32>,
    /// Lowest vertex of each node.
    pub member: Vec<VertexId>,
    /// Value of each node that has one.
    pub fixed: Vec<Option<f64>>,
    /// The extrema that the values ask for.
    pub wanted: WantedExtrema,
    /// Vertices that became parts of plateaus because no other value reaches them.
    pub constant: usize,
}

impl Contraction {
    /// Contracts the plateaus and decides which of them are extrema.
    ///
    /// # Arguments
    /// * `fixed`: value of each vertex that has one, at least one in every connected part.
    /// * `harmonic`: the harmonic function with these values, for positive edge weights.
    /// * `wanted`: the vertices whose nodes are to be the extrema; where absent, those are that the harmonic function has.
    pub fn new(
        complex: &SimplicialComplex,
        fixed: &[Option<f64>],
        harmonic: &[f64],
        wanted: Option<&WantedExtrema>,
    ) -> Result<Self, InterpolateError> {
        let given = fixed.iter().flatten().count();
        let mut fixed = fixed.to_vec();
        loop {
            let mut contraction = Self::of(complex, &fixed)?;
            contraction.wanted = match wanted {
                None => contraction.extrema_of(harmonic),
                Some(wanted) => contraction.nodes_of(wanted),
            };
            let regions = unreachable_regions(&contraction.graph, &contraction.wanted);
            if regions.is_empty() {
                contraction.constant = fixed.iter().flatten().count() - given;
                return Ok(contraction);
            }
            let mut grown = false;
            for region in &regions {
                let Some(value) = contraction.rim(region) else {
                    return Err(contraction.pinched(region));
                };
                // Nodes of several vertices have a value already.
                for member in region.iter().map(|node| contraction.member[node.index()]) {
                    grown |= fixed[member.index()].is_none();
                    fixed[member.index()] = Some(value);
                }
            }
            if !grown {
                return Err(contraction.pinched(&regions[0]));
            }
        }
    }

    fn pinched(&self, region: &[VertexId]) -> InterpolateError {
        InterpolateError::Pinched { vertex: self.member[region[0].index()], vertices: region.len() }
    }

    fn of(complex: &SimplicialComplex, fixed: &[Option<f64>]) -> Result<Self, MeshError> {
        let n = complex.vertex_count();
        let mut node = vec![NONE; n];
        let mut member = Vec::new();
        let mut stack = Vec::new();
        for seed in 0..n {
            if node[seed] != NONE {
                continue;
            }
            let number = member.len() as u32;
            member.push(VertexId::from(seed));
            node[seed] = number;
            if fixed[seed].is_none() {
                continue;
            }
            stack.push(VertexId::from(seed));
            while let Some(vertex) = stack.pop() {
                for &neighbour in complex.neighbours(vertex) {
                    if node[neighbour.index()] == NONE && fixed[neighbour.index()] == fixed[seed] {
                        node[neighbour.index()] = number;
                        stack.push(neighbour);
                    }
                }
            }
        }
        let mut edges: Vec<[u32; 2]> = complex
            .edges()
            .iter()
            .map(|edge| {
                let [a, b] = edge.map(|vertex| node[vertex.index()]);
                [a.min(b), a.max(b)]
            })
            .filter(|[a, b]| a != b)
            .collect();
        edges.sort_unstable();
        edges.dedup();
        let points = member.iter().map(|&vertex| complex.point(vertex)).collect();
        let graph = SimplicialComplex::new(1, points, edges.concat())?;
        let fixed = member.iter().map(|vertex| fixed[vertex.index()]).collect();
        Ok(Self { graph, node, member, fixed, wanted: WantedExtrema { minima: Vec::new(), maxima: Vec::new() }, constant: 0 })
    }

    /// The nodes with a value that have no lower, or no higher, neighbour in the harmonic function.
    fn extrema_of(&self, harmonic: &[f64]) -> WantedExtrema {
        let (low, high) = super::boundary::range(&self.fixed);
        let noise = NOISE * (high - low);
        let (mut minima, mut maxima) = (Vec::new(), Vec::new());
        for (index, value) in self.fixed.iter().enumerate() {
            let Some(value) = value else { continue };
            let vertex = VertexId::from(index);
            let beside = |&neighbour: &VertexId| harmonic[self.member[neighbour.index()].index()];
            let neighbours = self.graph.neighbours(vertex);
            let is_minimum = neighbours.iter().map(beside).all(|other| other >= value - noise);
            let is_maximum = neighbours.iter().map(beside).all(|other| other <= value + noise);
            match (is_minimum, is_maximum) {
                // The ends of the range are extrema of their kind though rounding hides that their neighbours differ.
                (true, _) if *value == low && !neighbours.is_empty() => minima.push(vertex),
                (_, true) if *value == high && !neighbours.is_empty() => maxima.push(vertex),
                (true, false) => minima.push(vertex),
                (false, true) => maxima.push(vertex),
                _ => {}
            }
        }
        WantedExtrema { minima, maxima }
    }

    fn nodes_of(&self, wanted: &WantedExtrema) -> WantedExtrema {
        let nodes = |vertices: &[VertexId]| {
            let mut nodes: Vec<VertexId> = vertices.iter().map(|vertex| VertexId(self.node[vertex.index()])).collect();
            nodes.sort_unstable();
            nodes.dedup();
            nodes.retain(|&node| !self.graph.neighbours(node).is_empty());
            nodes
        };
        WantedExtrema { minima: nodes(&wanted.minima), maxima: nodes(&wanted.maxima) }
    }

    /// The one value given in and around a region, if there is one and all nodes around have it.
    fn rim(&self, region: &[VertexId]) -> Option<f64> {
        let is_inside = |node: VertexId| region.binary_search(&node).is_ok();
        let around = region.iter().flat_map(|&node| self.graph.neighbours(node).iter().copied().filter(|&other| !is_inside(other)));
        let within = region.iter().copied().filter(|node| self.fixed[node.index()].is_some());
        let mut values = around.chain(within).map(|node| self.fixed[node.index()]);
        let first = values.next().flatten()?;
        values.all(|other| other == Some(first)).then_some(first)
    }

    /// A field on the nodes, given to their vertices.
    pub fn spread(&self, nodes: &[f64]) -> Vec<f64> {
        self.node.iter().map(|&node| nodes[node as usize]).collect()
    }
}
