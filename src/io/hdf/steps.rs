//! Time steps: windows into arrays that hold all of them, one behind the other.

use crate::io::error::{Fault, Place};

use super::store::Node;

/// The step that is read.
pub(super) struct Step {
    group: Node,
    /// Its number, from 0.
    pub number: u64,
    /// How many there are.
    pub count: u64,
}

/// The group of the steps and their number, if the data set has any.
pub(super) fn steps(node: &Node) -> Result<Option<(Node, u64)>, Fault> {
    let Some(group) = node.child("Steps")? else { return Ok(None) };
    let listed = match group.array("Values")? {
        Some(values) => values.shape[0],
        None => 0,
    };
    let count = match group.integers::<1>("NSteps")? {
        Some([count]) => u64::try_from(count).unwrap_or(0),
        None => listed,
    };
    if count == 0 || (listed != 0 && listed < count) {
        let found = format!("{count} steps with {listed} times in {}", group.path);
        return Err(Fault::new(Place::File, found, "a time for each step"));
    }
    Ok(Some((group, count)))
}

impl Step {
    pub fn new(group: Node, count: u64, number: u64) -> Self {
        Self { group, number, count }
    }

    /// The time of this step, where it is told.
    pub fn time(&self) -> Result<Option<f64>, Fault> {
        match self.group.array("Values")? {
            Some(values) => Ok(values.rows(self.number..self.number + 1)?.number(0)),
            None => Ok(None),
        }
    }

    /// The numbers of this step in an array of the group, `columns` of them; `None` without such an array.
    pub fn numbers(&self, path: [&str; 2], columns: usize) -> Result<Option<Vec<u64>>, Fault> {
        let array = match path {
            [name, ""] => self.group.array(name)?,
            [group, name] => match self.group.child(group)? {
                Some(group) => group.array(name)?,
                None => None,
            },
        };
        let Some(array) = array else { return Ok(None) };
        let numbers = array.integers(self.number..self.number + 1)?;
        if numbers.len() < columns {
            let found = format!("{} numbers a step in {}", numbers.len(), array.path);
            return Err(Fault::new(Place::File, found, format!("{columns}")));
        }
        counts(&numbers, &array.path).map(Some)
    }

    /// One number of this step.
    pub fn number(&self, path: [&str; 2]) -> Result<Option<u64>, Fault> {
        Ok(self.numbers(path, 1)?.map(|numbers| numbers[0]))
    }
}

/// Numbers that count something.
pub(super) fn counts(numbers: &[i64], path: &str) -> Result<Vec<u64>, Fault> {
    let count = |&number: &i64| {
        u64::try_from(number).map_err(|_| Fault::new(Place::File, format!("{number} in {path}"), "no number below 0"))
    };
    numbers.iter().map(count).collect()
}
