//! The windows of one side that are nearest somewhere: a lower envelope, kept while windows arrive.

use super::window::{Window, hypot};

/// A window that is nearer by less than this part of the distance changes nothing.
const TIE: f64 = 1e-13;
/// Shorter parts of a side, as parts of its length, go to the neighbouring window.
const SLIVER: f64 = 1e-12;

/// A window of an envelope.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub window: Window,
    /// Whether it has still to be carried across the triangle.
    pub is_pending: bool,
}

/// The windows of one side, by rising place, without overlap.
pub(super) type Envelope = Vec<Entry>;

/// Takes windows into an envelope as far as they are nearer than what is there.
///
/// # Arguments
/// * `windows`: in any order; fastest by rising place. They may overlap: rays from different points cross in a triangle.
/// * `length`: of the side.
/// * `scratch`: work memory, any contents.
pub(super) fn insert_all(envelope: &mut Envelope, windows: &[Window], length: f64, scratch: &mut Envelope) {
    let sliver = SLIVER * length;
    let mut rest = windows;
    let mut near = envelope.len();
    while let Some(window) = rest.first() {
        let place = seek(envelope, near, window.begin + sliver);
        // As many as fit in before the next window that is there.
        let limit = envelope.get(place).map_or(f64::INFINITY, |entry| entry.window.begin) + sliver;
        let mut at = f64::NEG_INFINITY;
        let mut fits = |window: &Window| std::mem::replace(&mut at, window.end) <= window.begin + sliver && window.end <= limit;
        let count = rest.iter().position(|window| !fits(window)).unwrap_or(rest.len());
        if count == 0 {
            insert(envelope, place, window, length, scratch);
            (near, rest) = (place, &rest[1..]);
            continue;
        }
        let fresh = rest[..count].iter().filter(|window| window.end - window.begin > sliver);
        let fresh = fresh.map(|&window| Entry { window, is_pending: true });
        if place == envelope.len() {
            envelope.extend(fresh);
        } else {
            envelope.splice(place..place, fresh);
        }
        (near, rest) = (place, &rest[count..]);
    }
}

/// The first entry that ends after `at`, sought from the entry `near` on.
fn seek(envelope: &Envelope, near: usize, at: f64) -> usize {
    let is_before = |entry: &Entry| entry.window.end <= at;
    if near > 0 && !is_before(&envelope[near - 1]) {
        return envelope[..near - 1].partition_point(is_before);
    }
    near + envelope[near..].iter().position(|entry| !is_before(entry)).unwrap_or(envelope.len() - near)
}

/// Takes one window into an envelope as far as it is nearer than what is there; `first` is the first entry that ends after its begin.
fn insert(envelope: &mut Envelope, first: usize, window: &Window, length: f64, scratch: &mut Envelope) {
    let sliver = SLIVER * length;
    if window.end - window.begin <= sliver {
        return;
    }
    let overlap = envelope[first..].iter().position(|entry| entry.window.begin >= window.end - sliver);
    let last = overlap.map_or(envelope.len(), |count| first + count);
    if first == last {
        envelope.insert(first, Entry { window: *window, is_pending: true });
        return;
    }
    scratch.clear();
    let mut is_taken = false;
    let mut at = window.begin;
    for &entry in &envelope[first..last] {
        let other = entry.window;
        if other.begin > at + sliver {
            // Nobody was here.
            push(scratch, window, at, other.begin, true);
            is_taken = true;
            at = other.begin;
        }
        let (low, high) = (at.max(other.begin), window.end.min(other.end));
        if low > other.begin {
            push(scratch, &other, other.begin, low, entry.is_pending);
        }
        if high > low {
            let cut = compare(window, &other, low, high);
            let mut from = low;
            for (part, &to) in cut.ends[..cut.count].iter().enumerate() {
                let is_new = (part % 2 == 0) == cut.is_first_new;
                if to - from > sliver || cut.count == 1 {
                    let (winner, is_pending) = if is_new { (window, true) } else { (&other, entry.is_pending) };
                    push(scratch, winner, from, to, is_pending);
                    is_taken |= is_new;
                    from = to;
                }
            }
            // A sliver at the end goes to the part before it.
            if let Some(last) = scratch.last_mut() {
                last.window.end = high;
            }
        }
        if other.end > high {
            push(scratch, &other, high.max(other.begin), other.end, entry.is_pending);
        }
        at = at.max(high);
    }
    if window.end > at + sliver {
        push(scratch, window, at, window.end, true);
        is_taken = true;
    }
    if is_taken {
        envelope.splice(first..last, scratch.iter().copied());
    }
}

/// Appends a part of a window, joined to the last one if that is the same window.
fn push(entries: &mut Envelope, window: &Window, begin: f64, end: f64, is_pending: bool) {
    if let Some(last) = entries.last_mut() {
        let same = last.window.x == window.x && last.window.y == window.y && last.window.sigma == window.sigma;
        if same && last.is_pending == is_pending && last.window.end == begin {
            last.window.end = end;
            return;
        }
    }
    entries.push(Entry { window: Window { begin, end, ..*window }, is_pending });
}

/// Who is nearer where: `count` parts that end at `ends`, by turns of the new window and the old one.
struct Cut {
    ends: [f64; 3],
    count: usize,
    is_first_new: bool,
}

/// Compares two windows between `low` and `high`, where both are defined.
fn compare(new: &Window, old: &Window, low: f64, high: f64) -> Cut {
    let whole = |is_new| Cut { ends: [high; 3], count: 1, is_first_new: is_new };
    let apart = hypot(new.x - old.x, new.y - old.y);
    let lead = new.sigma - old.sigma;
    // By the triangle inequality one of them is nowhere nearer than the other.
    if lead >= apart {
        return whole(false);
    }
    let gain = |at: f64| old.distance(at) - new.distance(at);
    let slack = TIE * (old.sigma + new.sigma + high.abs().max(apart));
    let (at_low, at_high) = (gain(low), gain(high));
    if (at_low > slack) != (at_high > slack) {
        let is_first_new = at_low > slack;
        return Cut { ends: [crossing(new, old, low, high, is_first_new), high, high], count: 2, is_first_new };
    }
    let is_new = at_low > slack;
    // The window with the longer way to its point wins on a convex set: it wins the whole if it wins both ends, and may win an inner
    // part if it wins neither. On equal ways the border is straight.
    let longer_is_new = lead > 0.0;
    if lead == 0.0 || longer_is_new == is_new || -lead >= apart {
        return whole(is_new);
    }
    match roots(new, old) {
        Some([a, b]) if low < a && b < high && b - a > f64::EPSILON * (high - low) => {
            let inner = gain((a + b) / 2.0);
            // Confirmed by values, whatever rounding did to the roots.
            if (inner > slack) == longer_is_new && inner.abs() > slack {
                Cut { ends: [a, b, high], count: 3, is_first_new: is_new }
            } else {
                whole(is_new)
            }
        }
        _ => whole(is_new),
    }
}

/// Where two windows are equally near, if one is nearer at `low` and the other at `high`.
fn crossing(new: &Window, old: &Window, mut low: f64, mut high: f64, is_low_new: bool) -> f64 {
    // Rises or falls through 0 from `low`, where it is positive, to `high`.
    let sign = if is_low_new { 1.0 } else { -1.0 };
    let enough = 1e-13 * (new.sigma + old.sigma + (high - low));
    let inside = roots(new, old).into_iter().flatten().find(|root| low < *root && *root < high);
    let mut at = inside.unwrap_or(low + (high - low) / 2.0);
    // Newton's method within the bracket; rounding spoils the roots of nearly straight or nearly touching borders.
    for _ in 0..40 {
        let (r_new, r_old) = (hypot(at - new.x, new.y), hypot(at - old.x, old.y));
        let gain = sign * ((old.sigma - new.sigma) + (r_old - r_new));
        if gain.abs() <= enough {
            break;
        }
        if gain > 0.0 { low = at } else { high = at }
        let slope = sign * ((at - old.x) / r_old - (at - new.x) / r_new);
        let step = at - gain / slope;
        at = if low < step && step < high { step } else { low + (high - low) / 2.0 };
    }
    at
}

/// Where the bisector of two weighted points crosses the side, or its mirror image does, rising.
///
/// With `r` the distances from the points and `d` the difference of the weights, `r_new = r_old + d` gives, squared twice,
/// `(alpha b + beta)^2 = 4 d^2 ((b - x)^2 + y^2)` with the old point `(x, y)`.
fn roots(new: &Window, old: &Window) -> Option<[f64; 2]> {
    let d = old.sigma - new.sigma;
    // Places are counted from the old point's foot.
    let away = new.x - old.x;
    let (alpha, beta) = (-2.0 * away, away * away + new.y * new.y - old.y * old.y - d * d);
    let four = 4.0 * d * d;
    let (a, half_b, c) = (alpha * alpha - four, alpha * beta, beta * beta - four * old.y * old.y);
    if d == 0.0 {
        let root = old.x - beta / alpha;
        return root.is_finite().then_some([root; 2]);
    }
    let discriminant = half_b * half_b - a * c;
    if discriminant < 0.0 {
        return None;
    }
    let q = -(half_b + half_b.signum() * discriminant.sqrt());
    let (first, second) = (q / a, c / q);
    let pair = match (first.is_finite(), second.is_finite()) {
        (true, true) => [first.min(second), first.max(second)],
        (true, false) => [first; 2],
        (false, true) => [second; 2],
        (false, false) => return None,
    };
    Some(pair.map(|root| root + old.x))
}
