//! The other road: reduction of boundary matrices modulo 2, on lists of cells as plain vertex sets.

use std::collections::{BTreeMap, BTreeSet};

use morsmooth::field::{VertexId, VertexOrder};
use morsmooth::mesh::SimplicialComplex;

/// A cell as its vertices by falling rank, which is how the lower-star filtration compares cells.
type RankedCell = Vec<u32>;

fn filtration(complex: &SimplicialComplex, order: &VertexOrder) -> Vec<RankedCell> {
    let mut cells = BTreeSet::new();
    for corners in complex.simplices().chunks_exact(complex.dimension() + 1) {
        for subset in 1u32..1 << corners.len() {
            let members = (0..corners.len()).filter(|corner| subset >> corner & 1 == 1);
            let mut ranks: RankedCell = members.map(|corner| order.rank(VertexId(corners[corner]))).collect();
            ranks.sort_unstable_by(|a, b| b.cmp(a));
            cells.insert(ranks);
        }
    }
    // Lexicographic: by highest vertex, a face before its cofaces.
    cells.into_iter().collect()
}

/// Persistence pairs and unpaired cells of the lower-star filtration by reduction of the whole boundary matrix.
fn reduce(cells: &[RankedCell]) -> (Vec<(usize, usize)>, Vec<usize>) {
    let place: BTreeMap<&RankedCell, usize> = cells.iter().enumerate().map(|(place, cell)| (cell, place)).collect();
    let mut column_of_low: BTreeMap<usize, (usize, BTreeSet<usize>)> = BTreeMap::new();
    let mut unpaired: BTreeSet<usize> = (0..cells.len()).collect();
    for (number, cell) in cells.iter().enumerate() {
        let mut column = BTreeSet::new();
        if cell.len() > 1 {
            for omitted in 0..cell.len() {
                let mut face = cell.clone();
                face.remove(omitted);
                column.insert(place[&face]);
            }
        }
        while let Some(&low) = column.last() {
            match column_of_low.get(&low) {
                Some((_, other)) => column = column.symmetric_difference(other).copied().collect(),
                None => {
                    unpaired.remove(&low);
                    unpaired.remove(&number);
                    column_of_low.insert(low, (number, column));
                    break;
                }
            }
        }
    }
    (column_of_low.into_iter().map(|(low, (number, _))| (low, number)).collect(), unpaired.into_iter().collect())
}

/// Minima with the vertex at which they die, by rising rank of the minimum.
pub fn minimum_pairs(complex: &SimplicialComplex, order: &VertexOrder) -> Vec<(VertexId, Option<VertexId>)> {
    let cells = filtration(complex, order);
    let vertex = |rank: u32| order.sequence()[rank as usize];
    let (pairs, unpaired) = reduce(&cells);
    let dying = pairs
        .into_iter()
        .filter(|&(low, high)| cells[low].len() == 1 && cells[low][0] != cells[high][0])
        .map(|(low, high)| (cells[low][0], Some(vertex(cells[high][0]))));
    let essential = unpaired.into_iter().filter(|&cell| cells[cell].len() == 1).map(|cell| (cells[cell][0], None));
    let mut found: Vec<_> = dying.chain(essential).collect();
    found.sort_unstable();
    found.into_iter().map(|(rank, saddle)| (vertex(rank), saddle)).collect()
}

/// The whole diagram as (dimension, birth vertex, death vertex), sorted, without what is born and dies at one vertex.
pub fn diagram(complex: &SimplicialComplex, order: &VertexOrder) -> Vec<(u8, VertexId, Option<VertexId>)> {
    let cells = filtration(complex, order);
    let vertex = |cell: usize| order.sequence()[cells[cell][0] as usize];
    let dimension = |cell: usize| cells[cell].len() as u8 - 1;
    let (pairs, unpaired) = reduce(&cells);
    let finite = pairs.into_iter().map(|(low, high)| (dimension(low), vertex(low), Some(vertex(high))));
    let essential = unpaired.into_iter().map(|cell| (dimension(cell), vertex(cell), None));
    let mut found: Vec<_> = finite.chain(essential).filter(|&(_, birth, death)| death != Some(birth)).collect();
    found.sort_unstable();
    found
}

/// Betti numbers modulo 2.
pub fn betti_numbers(complex: &SimplicialComplex) -> [usize; 4] {
    let order = VertexOrder::of_values(&vec![0.0; complex.vertex_count()]).unwrap();
    let cells = filtration(complex, &order);
    let mut betti = [0; 4];
    for cell in reduce(&cells).1 {
        betti[cells[cell].len() - 1] += 1;
    }
    betti
}

/// Rank modulo 2 of a matrix given as columns of row numbers.
pub fn rank_modulo_2(columns: Vec<BTreeSet<usize>>) -> usize {
    let mut by_low: BTreeMap<usize, BTreeSet<usize>> = BTreeMap::new();
    for mut column in columns {
        while let Some(&low) = column.last() {
            match by_low.get(&low) {
                Some(other) => column = column.symmetric_difference(other).copied().collect(),
                None => {
                    by_low.insert(low, column);
                    break;
                }
            }
        }
    }
    by_low.len()
}
