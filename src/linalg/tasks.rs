//! Which subtrees run side by side, and where everything lies in their work memory.

use super::assembly::{Assembly, NONE};

/// Subtrees with less work than this stay within one task; waking a thread costs a thousandth of it.
const SMALLEST: f64 = 3e7;

/// A task is cut off where it has at least this share of all work.
const SHARE: f64 = 1.0 / 32.0;

/// A run of supernodes that is eliminated in order by one thread, except for the subtrees that run first and side by side.
///
/// The cut depends on the matrix only, never on the number of threads.
#[derive(Debug, Default)]
pub(super) struct Task {
    /// First supernode, inner tasks included.
    pub first: usize,
    /// One past the last supernode.
    pub end: usize,
    /// The subtrees that run first, in order; their roots are children of [`branch`](Self::branch).
    pub inner: Vec<Task>,
    /// The supernode that takes the updates of the inner tasks; none at the roots of the forest.
    pub branch: Option<usize>,
    /// Numbers in the two stacks of update matrices.
    pub matrices: [usize; 2],
    /// Numbers in the two stacks of vectors on the way up, for one right-hand side.
    pub vectors: [usize; 2],
    /// Most numbers below the diagonal block of a supernode.
    pub below: usize,
    /// Numbers in the memory of vectors on the way down, for one right-hand side.
    pub downwards: usize,
}

/// Where each supernode keeps what it passes on, within the memory of its task.
#[derive(Debug)]
pub(super) struct Places {
    /// Of the update matrix, in the stack of the supernode's parity.
    pub matrix: Vec<usize>,
    /// Of the vector on the way up, in the stack of the supernode's parity.
    pub vector: Vec<usize>,
    /// Of the vector on the way down.
    pub downwards: Vec<usize>,
}

/// Cuts a forest into tasks and lays out their memory.
pub(super) fn plan(assembly: &Assembly) -> (Task, Places) {
    let count = assembly.count();
    let mut work = assembly.flops.clone();
    let mut first: Vec<usize> = (0..count).collect();
    for supernode in 0..count {
        let parent = assembly.parent[supernode];
        if parent != NONE {
            work[parent as usize] += work[supernode];
            first[parent as usize] = first[parent as usize].min(first[supernode]);
        }
    }
    let roots: Vec<u32> = (0..count as u32).filter(|&supernode| assembly.parent[supernode as usize] == NONE).collect();
    let total: f64 = roots.iter().map(|&root| work[root as usize]).sum();
    let cutter = Cutter { assembly, work, first, least: (SHARE * total).max(SMALLEST) };
    let mut root = Task { end: count, ..Task::default() };
    cutter.split(&mut root, None, &roots);
    let mut places = Places { matrix: vec![0; count], vector: vec![0; count], downwards: vec![0; count] };
    lay_out(&mut root, assembly, &mut places);
    (root, places)
}

struct Cutter<'a> {
    assembly: &'a Assembly,
    /// Of whole subtrees.
    work: Vec<f64>,
    /// First supernode of each subtree.
    first: Vec<usize>,
    least: f64,
}

impl Cutter<'_> {
    /// Finds the highest place below `branch` where at least two runs of siblings are worth a task each.
    fn split(&self, task: &mut Task, mut branch: Option<usize>, roots: &[u32]) {
        let mut siblings = roots;
        loop {
            let runs = self.runs(siblings);
            match runs[..] {
                [] => return,
                [(from, to)] => {
                    // One worthwhile run: if it is a single subtree look further down in it, else nothing is gained.
                    if to - from > 1 {
                        return;
                    }
                    let only = siblings[from] as usize;
                    branch = Some(only);
                    siblings = self.assembly.children(only);
                }
                _ => {
                    task.branch = branch;
                    task.inner = runs.into_iter().map(|(from, to)| self.run_of(&siblings[from..to])).collect();
                    return;
                }
            }
        }
    }

    fn run_of(&self, siblings: &[u32]) -> Task {
        let (first, last) = (siblings[0] as usize, siblings[siblings.len() - 1] as usize);
        let mut task = Task { first: self.first[first], end: last + 1, ..Task::default() };
        if siblings.len() == 1 {
            self.split(&mut task, Some(last), self.assembly.children(last));
        }
        task
    }

    /// Runs of consecutive siblings with enough work; what is large enough by itself stays alone.
    fn runs(&self, siblings: &[u32]) -> Vec<(usize, usize)> {
        let mut runs = Vec::new();
        let (mut begin, mut sum) = (0, 0.0);
        for (place, &sibling) in siblings.iter().enumerate() {
            let work = self.work[sibling as usize];
            if work >= self.least {
                runs.push((place, place + 1));
                (begin, sum) = (place + 1, 0.0);
                continue;
            }
            sum += work;
            if sum >= self.least {
                runs.push((begin, place + 1));
                (begin, sum) = (place + 1, 0.0);
            }
        }
        runs
    }
}

impl Task {
    /// The runs of supernodes that the task eliminates itself, in order.
    pub fn own(&self) -> impl DoubleEndedIterator<Item = (usize, usize)> {
        let gaps = self.inner.len() + 1;
        (0..gaps).map(move |gap| {
            let begin = if gap == 0 { self.first } else { self.inner[gap - 1].end };
            let end = if gap + 1 == gaps { self.end } else { self.inner[gap].first };
            (begin, end)
        })
    }

    /// Whether a supernode belongs to one of the inner tasks.
    pub fn is_inner(&self, supernode: usize) -> bool {
        self.inner.iter().any(|task| (task.first..task.end).contains(&supernode))
    }
}

fn lay_out(task: &mut Task, assembly: &Assembly, places: &mut Places) {
    let (mut matrices, mut vectors) = ([0; 2], [0; 2]);
    let own: Vec<(usize, usize)> = task.own().collect();
    for supernode in own.iter().flat_map(|&(begin, end)| begin..end) {
        let (mine, other) = (assembly.parity[supernode] as usize, 1 - assembly.parity[supernode] as usize);
        let size = assembly.reach(supernode).pow(2);
        task.below = task.below.max(assembly.reach(supernode) * assembly.width(supernode));
        places.matrix[supernode] = matrices[mine];
        places.vector[supernode] = vectors[mine];
        matrices[mine] += size;
        vectors[mine] += assembly.height(supernode);
        for stack in 0..2 {
            task.matrices[stack] = task.matrices[stack].max(matrices[stack]);
            task.vectors[stack] = task.vectors[stack].max(vectors[stack]);
        }
        let is_branch = task.branch == Some(supernode);
        for &child in assembly.children(supernode) {
            let child = child as usize;
            if !(is_branch && task.is_inner(child)) {
                matrices[other] -= assembly.reach(child).pow(2);
                vectors[other] -= assembly.height(child);
            }
        }
    }
    // On the way down the children of the branch write where the branch would lie; itself it lies behind all others.
    let after = |supernode: usize, places: &Places| {
        let parent = assembly.parent[supernode];
        if parent == NONE || parent as usize >= task.end {
            0
        } else if task.branch == Some(parent as usize) {
            places.downwards[parent as usize]
        } else {
            places.downwards[parent as usize] + assembly.height(parent as usize)
        }
    };
    for supernode in own.iter().rev().flat_map(|&(begin, end)| (begin..end).rev()) {
        places.downwards[supernode] = after(supernode, places);
        if task.branch != Some(supernode) {
            task.downwards = task.downwards.max(places.downwards[supernode] + assembly.height(supernode));
        }
    }
    if let Some(branch) = task.branch {
        places.downwards[branch] = task.downwards;
        task.downwards += assembly.height(branch);
    }
    for inner in &mut task.inner {
        lay_out(inner, assembly, places);
    }
}
