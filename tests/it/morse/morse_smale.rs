//! Critical points, lines and regions.

use std::collections::{BTreeMap, BTreeSet};

use morsmooth::field::{VertexId, VertexOrder};
use morsmooth::mesh::{Domain, Grid, ImplicitGrid, Mask, SimplicialComplex, Triangulation};
use morsmooth::morse::{
    Cell, ExtremumKind, LineKind, MorseComplex, MorseHierarchy, MorseSmaleComplex, Pairing, SaddlePairs, Segmentation, extremum_pairs,
};
use proptest::prelude::*;

use super::gradient::vertices;
use super::meshes;

fn is_face(complex: &SimplicialComplex, a: Cell, b: Cell) -> bool {
    let (small, large) = if a.dimension < b.dimension { (a, b) } else { (b, a) };
    let outer = vertices(complex, large);
    small.dimension + 1 == large.dimension && vertices(complex, small).iter().all(|vertex| outer.contains(vertex))
}

/// The part of an ascending line inside of the domain, the rest along its boundary.
fn split(dimension: u8, cells: &[Cell]) -> (&[Cell], &[Cell]) {
    let leaves = cells.iter().position(|cell| cell.dimension + 1 < dimension || dimension == 2 && cell.dimension == 0);
    match leaves {
        Some(place) => cells.split_at(place),
        None => (cells, &[]),
    }
}

fn check(complex: &SimplicialComplex, hierarchy: &MorseHierarchy<'_, SimplicialComplex>, is_simplified: bool) -> MorseSmaleComplex {
    let smale = MorseSmaleComplex::new(hierarchy);
    let (gradient, order) = (hierarchy.gradient(), hierarchy.order());
    let dimension = complex.dimension() as u8;
    // Points: every critical cell once, and maxima without one.
    let cells: BTreeSet<Cell> = smale.points.iter().map(|point| point.cell).collect();
    assert_eq!(cells.len(), smale.points.len(), "no cell twice");
    let critical: BTreeSet<Cell> = (0..=3).flat_map(|k| gradient.critical_cells(k)).collect();
    assert!(critical.is_subset(&cells));
    let counts = [0u8, 1, 2, 3].map(|k| smale.points.iter().filter(|point| point.cell.dimension == k).count());
    assert_eq!(counts, smale.counts);
    assert!(smale.points.windows(2).all(|pair| pair[0].cell.dimension <= pair[1].cell.dimension));
    assert_eq!(smale.points.len() - critical.len(), smale.boundary_maxima);
    for point in &smale.points {
        assert_eq!(point.vertex, point.cell.highest_vertex(complex, order));
    }
    // Labels are places.
    let first = smale.points.len() - counts[dimension as usize];
    for (segmentation, first) in [(&smale.minima, 0), (&smale.maxima, first)] {
        let listed: Vec<VertexId> =
            smale.points[first..][..segmentation.extrema().len()].iter().map(|point| point.vertex).collect();
        assert_eq!(listed, segmentation.extrema());
        let sizes: Vec<usize> =
            smale.points[first..][..segmentation.extrema().len()].iter().map(|point| point.region_size).collect();
        assert_eq!(sizes, segmentation.sizes());
    }
    for vertex in (0..complex.vertex_count()).map(VertexId::from) {
        let pair = smale.regions.label(vertex).map(|label| smale.regions.pairs()[label as usize]);
        let both = smale.minima.label(vertex).zip(smale.maxima.label(vertex)).map(|(minimum, maximum)| [minimum, maximum]);
        assert_eq!(pair, both);
    }
    let used: BTreeSet<_> = (0..complex.vertex_count()).filter_map(|vertex| smale.regions.label(vertex.into())).collect();
    assert_eq!(used.len(), smale.regions.pairs().len(), "labels are dense");
    // Lines.
    let mut arcs: BTreeMap<(Cell, Cell), u64> = BTreeMap::new();
    for line in &smale.lines {
        let [source, destination] = [line.source, line.destination].map(|place| smale.points[place]);
        let (begin, end) = (line.cells[0], *line.cells.last().unwrap());
        assert_eq!((source.cell, destination.cell), (begin, end));
        let expected = match line.kind {
            LineKind::Descending => (1, 0),
            LineKind::Ascending => (dimension - 1, dimension),
            LineKind::Connector => (1, 2),
        };
        assert_eq!((begin.dimension, end.dimension), expected);
        assert!(gradient.is_critical(begin));
        let (inner, outer) = if line.kind == LineKind::Ascending { split(dimension, &line.cells) } else { (&line.cells[..], &[][..]) };
        for (place, step) in inner.windows(2).enumerate() {
            assert!(is_face(complex, step[0], step[1]));
            let is_arrow = gradient.pairing(step[0]) == Pairing::Up(step[1]) || gradient.pairing(step[1]) == Pairing::Up(step[0]);
            assert_eq!(place % 2 == 1, is_arrow, "every other step is an arrow");
        }
        if outer.is_empty() {
            assert!(gradient.is_critical(end));
            let ends = if begin.dimension > end.dimension { (begin, end) } else { (end, begin) };
            *arcs.entry(ends).or_default() += 1;
        } else {
            let rim = inner.last().unwrap();
            assert!(vertices(complex, *rim).contains(&outer[0].index), "on the boundary from the facet on");
            let walk = &outer[..outer.len() - 1];
            assert!(walk.windows(2).all(|step| is_face(complex, step[0], step[1])));
            assert_eq!(*walk.last().unwrap(), Cell::vertex(destination.vertex));
        }
        if !is_simplified {
            let heights: Vec<u32> = line.cells.iter().map(|cell| order.rank(cell.highest_vertex(complex, order))).collect();
            let is_monotone = match line.kind {
                LineKind::Descending => heights.windows(2).all(|step| step[0] >= step[1]),
                LineKind::Ascending | LineKind::Connector => heights.windows(2).all(|step| step[0] <= step[1]),
            };
            assert!(is_monotone, "{:?} line is not monotone: {heights:?}", line.kind);
        }
    }
    // Every V-path of the Morse complex that is listed one by one is a line.
    let morse = MorseComplex::new(complex, gradient);
    let mut expected: BTreeMap<(Cell, Cell), u64> = BTreeMap::new();
    let mut tangled = BTreeSet::new();
    for (top, bottom, separatrix) in morse.separatrices() {
        if separatrix.multiplicity == 1 {
            *expected.entry((top, bottom)).or_default() += 1;
        } else {
            tangled.insert((top, bottom));
        }
    }
    if is_plain(complex) {
        assert_eq!(arcs, expected);
        assert_eq!(smale.tangled, tangled.len());
    }
    smale
}

/// No facet of more than two top cells.
fn is_plain(complex: &SimplicialComplex) -> bool {
    let mut tops: BTreeMap<Vec<u32>, usize> = BTreeMap::new();
    for corners in complex.simplices().chunks_exact(complex.dimension() + 1) {
        for omitted in 0..corners.len() {
            let mut facet = corners.to_vec();
            facet.remove(omitted);
            facet.sort_unstable();
            *tops.entry(facet).or_default() += 1;
        }
    }
    tops.values().all(|&count| count <= 2)
}

proptest! {
    #[test]
    fn complexes_of_any_kind((complex, values) in meshes::random_field(), threshold in -1..8i32) {
        let order = VertexOrder::of_values(&values).unwrap();
        let mut hierarchy = MorseHierarchy::new(&complex, &values, &order, SaddlePairs::Cancel).unwrap();
        hierarchy.at(f64::from(threshold));
        check(&complex, &hierarchy, threshold >= 0);
    }
}

#[test]
fn meshes_with_and_without_boundary() {
    for (name, complex, _) in meshes::all() {
        for levels in [3, 1 << 40] {
            let values = meshes::noise(complex.vertex_count(), 77, levels);
            let order = VertexOrder::of_values(&values).unwrap();
            let mut hierarchy = MorseHierarchy::new(&complex, &values, &order, SaddlePairs::Cancel).unwrap();
            for threshold in [-1.0, 0.0, 0.4, 0.8] {
                hierarchy.at(threshold);
                let smale = check(&complex, &hierarchy, threshold >= 0.0);
                let is_closed = ["torus", "sphere", "three-torus"].contains(&name);
                if is_closed {
                    assert!(smale.points.iter().all(|point| !point.is_on_boundary), "{name}");
                    assert_eq!(smale.boundary_maxima, 0);
                    let per_saddle = smale.lines.iter().filter(|line| line.kind != LineKind::Connector).count();
                    let saddles = if complex.dimension() == 2 { 2 * smale.counts[1] } else { smale.counts[1] + smale.counts[2] };
                    assert_eq!(per_saddle, 2 * saddles, "two lines down and two up from every saddle");
                }
            }
        }
    }
}

#[test]
fn all_extrema_are_points_those_on_the_boundary_too() {
    let grid = meshes::grid(30, 20);
    let values = meshes::noise(600, 9, 1 << 40);
    let order = VertexOrder::of_values(&values).unwrap();
    let hierarchy = MorseHierarchy::new(&grid, &values, &order, SaddlePairs::Keep).unwrap();
    let smale = MorseSmaleComplex::new(&hierarchy);
    for (kind, dimension) in [(ExtremumKind::Minimum, 0), (ExtremumKind::Maximum, 2)] {
        let mut expected: Vec<VertexId> = extremum_pairs(&grid, &order, kind).iter().map(|pair| pair.extremum).collect();
        expected.sort_unstable();
        let of_kind = smale.points.iter().filter(|point| point.cell.dimension == dimension);
        assert_eq!(of_kind.map(|point| point.vertex).collect::<Vec<_>>(), expected);
    }
    assert!(smale.boundary_maxima > 0);
    let reached: BTreeSet<usize> = smale.lines.iter().map(|line| line.destination).collect();
    let maxima = smale.points.len() - smale.counts[2]..smale.points.len();
    let lonely = maxima.clone().filter(|place| !reached.contains(place)).count();
    assert!(lonely * 10 < maxima.len(), "{lonely} of {} maxima are at no end of a line", maxima.len());
}

#[test]
fn two_hills_and_a_saddle() {
    // sin x sin y over [0, 2 pi]^2, lifted by a bowl so that boundary values are no extrema of interest.
    let n = 41;
    let grid = meshes::grid(n, n);
    let at = |k: usize| (k as f64 + 0.013) / (n - 1) as f64 * std::f64::consts::TAU;
    let values: Vec<f64> = (0..n * n).map(|k| at(k % n).sin() * at(k / n).sin()).collect();
    let order = VertexOrder::of_values(&values).unwrap();
    let mut hierarchy = MorseHierarchy::new(&grid, &values, &order, SaddlePairs::Keep).unwrap();
    hierarchy.at(0.3);
    let smale = check(&grid, &hierarchy, true);
    let place = |vertex: VertexId| [vertex.index() % n, vertex.index() / n];
    let inside = |dimension: u8| -> Vec<[usize; 2]> {
        let points = smale.points.iter().filter(|point| point.cell.dimension == dimension);
        points.map(|point| place(point.vertex)).filter(|at| at.iter().all(|&k| k > 3 && k < n - 4)).collect()
    };
    assert_eq!(inside(0), [[30, 10], [10, 30]]);
    assert_eq!(inside(2), [[10, 10], [30, 30]]);
    let saddles = inside(1);
    assert!(saddles.iter().any(|at| at.iter().all(|&k| (19..=21).contains(&k))), "{saddles:?}");
}

/// Follow the pairs back from an edge between two basins: of the two or three such edges of a triangle one is paired with
/// it, so the way back ends in a critical edge between two basins.
#[test]
fn every_edge_between_two_basins_of_minima_lies_on_a_line_up() {
    for (name, complex, _) in meshes::all() {
        if complex.dimension() != 2 {
            continue;
        }
        for levels in [4, 1 << 40] {
            let values = meshes::noise(complex.vertex_count(), 41, levels);
            let order = VertexOrder::of_values(&values).unwrap();
            let mut hierarchy = MorseHierarchy::new(&complex, &values, &order, SaddlePairs::Keep).unwrap();
            for threshold in [-1.0, 0.0, 0.3, 0.6] {
                hierarchy.at(threshold);
                let smale = MorseSmaleComplex::new(&hierarchy);
                let lines = smale.lines.iter().filter(|line| line.kind == LineKind::Ascending);
                let on_lines: BTreeSet<Cell> = lines.flat_map(|line| line.cells.iter().copied()).collect();
                let mut between = 0;
                for (number, ends) in complex.edges().iter().enumerate() {
                    let [a, b] = ends.map(|end| smale.minima.label(end));
                    if a != b {
                        between += 1;
                        let edge = Cell { dimension: 1, index: number as u32 };
                        assert!(on_lines.contains(&edge), "{name}: edge {ends:?} above {threshold}");
                    }
                }
                assert_eq!(between > 0, smale.minima.extrema().len() > components(&complex));
            }
        }
    }
}

fn components(complex: &SimplicialComplex) -> usize {
    let (component, count) = complex.components();
    let lonely = (0..complex.vertex_count()).filter(|&vertex| complex.neighbours(vertex.into()).is_empty());
    let lonely: BTreeSet<u32> = lonely.map(|vertex| component[vertex]).collect();
    count - lonely.len()
}

type Summary = (Vec<(u8, VertexId, bool, usize)>, Vec<(LineKind, usize, usize, usize)>, [Segmentation; 2], usize);

/// Critical points by dimension and vertex, ends of lines, and labels: what does not depend on the numbers of cells.
fn summary<T: Triangulation>(complex: &T, values: &[f64], threshold: f64) -> Summary {
    let order = VertexOrder::of_values(values).unwrap();
    let mut hierarchy = MorseHierarchy::new(complex, values, &order, SaddlePairs::Cancel).unwrap();
    hierarchy.at(threshold);
    let smale = MorseSmaleComplex::new(&hierarchy);
    let points: Vec<_> = smale.points.iter().map(|point| (point.cell.dimension, point.vertex, point.is_on_boundary, point.region_size)).collect();
    let lines: Vec<_> = smale.lines.iter().map(|line| (line.kind, line.source, line.destination, line.cells.len())).collect();
    (points, lines, [smale.minima, smale.maxima], smale.tangled)
}

#[test]
fn a_grid_without_stored_cells_gives_the_same() {
    for dims in [[40, 1, 1], [17, 12, 1], [7, 6, 5]] {
        let grid = Grid::image(dims, [0.0; 3], [1.0; 3]);
        let explicit = Domain::from_grid(&grid, &Mask::none()).unwrap();
        let implicit = ImplicitGrid::new(grid).unwrap();
        for levels in [5, 1 << 40] {
            let values = meshes::noise(dims.iter().product(), 3, levels);
            for threshold in [-1.0, 0.0, 0.3, 0.7] {
                let (one, other) = (summary(&explicit.complex, &values, threshold), summary(&implicit, &values, threshold));
                assert!(one == other, "{dims:?}, {levels} levels, above {threshold}");
            }
        }
    }
}
