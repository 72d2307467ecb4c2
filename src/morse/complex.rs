//! The Morse complex as a graph. The only place of the crate `petgraph` in this module.

use std::collections::BTreeMap;

use petgraph::Direction;
use petgraph::graph::{DiGraph, NodeIndex};
use petgraph::visit::EdgeRef;
use rayon::prelude::*;

use crate::mesh::{Cell, Triangulation};

use super::gradient::DiscreteGradient;
use super::v_paths::{Separatrix, separatrices_below};

/// The Morse complex of a discrete gradient: a graph of critical cells and the separatrices between them.
///
/// Arcs lead from a critical cell of dimension k to one of dimension k-1. Two V-paths between the same two cells are
/// two arcs.
#[derive(Debug, Clone)]
pub struct MorseComplex {
    graph: DiGraph<Cell, Separatrix>,
    nodes: BTreeMap<Cell, NodeIndex>,
}

impl MorseComplex {
    /// Traces all V-paths between critical cells of adjacent dimension.
    ///
    /// # Arguments
    /// * `gradient`: a gradient on `complex`, simplified or not.
    ///
    /// # Cost
    /// Linear in the number of cells that V-paths reach, times the number of critical cells that reach them: on a
    /// manifold about linear in the cells for the separatrices of extrema. Parallel over critical cells; the result
    /// does not depend on the number of threads.
    ///
    /// # Source
    /// Forman 1998, section 8; Robins, Wood, Sheppard 2011, algorithm *ExtractMorseComplex*.
    pub fn new<T: Triangulation>(complex: &T, gradient: &DiscreteGradient) -> Self {
        let critical: Vec<Cell> = (0..=gradient.dimension()).flat_map(|dim| gradient.critical_cells(dim)).collect();
        let below: Vec<Vec<(Cell, Separatrix)>> =
            critical.par_iter().map(|&cell| separatrices_below(complex, gradient, cell)).collect();
        let mut graph = DiGraph::new();
        let nodes: BTreeMap<Cell, NodeIndex> = critical.iter().map(|&cell| (cell, graph.add_node(cell))).collect();
        for (cell, below) in critical.iter().zip(below) {
            for (end, separatrix) in below {
                graph.add_edge(nodes[cell], nodes[&end], separatrix);
            }
        }
        Self { graph, nodes }
    }

    /// The critical cells by dimension, then number.
    pub fn critical_cells(&self) -> impl Iterator<Item = Cell> {
        self.nodes.keys().copied()
    }

    /// All separatrices with the critical cells at their upper and lower end, by upper end.
    pub fn separatrices(&self) -> impl Iterator<Item = (Cell, Cell, &Separatrix)> {
        let graph = &self.graph;
        graph.edge_references().map(|arc| (graph[arc.source()], graph[arc.target()], arc.weight()))
    }

    /// Separatrices from a critical cell down, each with its lower end; none for another cell.
    pub fn below(&self, cell: Cell) -> impl Iterator<Item = (Cell, &Separatrix)> {
        self.arcs(cell, Direction::Outgoing).map(|arc| (self.graph[arc.target()], arc.weight()))
    }

    /// Separatrices from a critical cell up, each with its upper end; none for another cell.
    pub fn above(&self, cell: Cell) -> impl Iterator<Item = (Cell, &Separatrix)> {
        self.arcs(cell, Direction::Incoming).map(|arc| (self.graph[arc.source()], arc.weight()))
    }

    /// The first two critical cells, two dimensions apart, between which the boundary of the boundary does not
    /// vanish modulo 2. There are none in the Morse complex of a discrete gradient.
    ///
    /// # Cost
    /// Linear in the number of pairs of adjacent arcs.
    pub fn boundary_defect(&self) -> Option<(Cell, Cell)> {
        self.critical_cells().find_map(|top| {
            let mut odd: BTreeMap<Cell, bool> = BTreeMap::new();
            for (middle, upper) in self.below(top) {
                for (bottom, lower) in self.below(middle) {
                    *odd.entry(bottom).or_default() ^= upper.multiplicity & lower.multiplicity & 1 == 1;
                }
            }
            odd.into_iter().find(|&(_, odd)| odd).map(|(bottom, _)| (top, bottom))
        })
    }

    fn arcs(
        &self,
        cell: Cell,
        direction: Direction,
    ) -> impl Iterator<Item = petgraph::graph::EdgeReference<'_, Separatrix>> {
        self.nodes.get(&cell).into_iter().flat_map(move |&node| self.graph.edges_directed(node, direction))
    }
}
