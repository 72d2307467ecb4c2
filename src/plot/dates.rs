//! Round dates for the axis of a series.

use super::ticks::round_step;

const YEAR: f64 = 365.2425;
const MONTH: f64 = YEAR / 12.0;

/// Round dates in `[low, high]`, days since 1970-01-01, at most about `count`, and their labels.
pub(super) fn date_ticks(low: f64, high: f64, count: usize) -> Vec<(f64, String)> {
    let step = (high - low) / count.max(1) as f64;
    if step > MONTH * 6.0 {
        return months(low, high, 12 * round_step((step / YEAR).max(1.0)) as i64, |year, _| format!("{year}"));
    }
    if step > MONTH * 0.6 {
        let every = [1, 2, 3, 6].into_iter().find(|&every| every as f64 * MONTH >= step).unwrap_or(12);
        return months(low, high, every, |year, month| format!("{year}-{month:02}"));
    }
    // Within a month: days, then parts of days.
    const PARTS: [f64; 13] =
        [1.0 / 86_400.0, 1.0 / 1440.0, 1.0 / 288.0, 1.0 / 96.0, 1.0 / 48.0, 1.0 / 24.0, 0.125, 0.25, 0.5, 1.0, 2.0, 5.0, 10.0];
    let every = PARTS.into_iter().find(|&part| part >= step).unwrap_or(20.0);
    let (first, last) = ((low / every - 1e-9).ceil() as i64, (high / every + 1e-9).floor() as i64);
    (first..=last).map(|k| (k as f64 * every, date_label(k as f64 * every, every < 1.0))).collect()
}

/// First days of every `step`-th month.
fn months(low: f64, high: f64, step: i64, label: impl Fn(i64, i64) -> String) -> Vec<(f64, String)> {
    let step = step.max(1);
    let (year, month, _) = civil(low.floor() as i64);
    let mut ticks = Vec::new();
    let mut index = (year * 12 + month - 1).div_euclid(step) * step;
    loop {
        let (year, month) = (index.div_euclid(12), index.rem_euclid(12) + 1);
        let day = day_of(year, month) as f64;
        if day > high {
            return ticks;
        }
        if day >= low {
            ticks.push((day, label(year, month)));
        }
        index += step;
    }
}

/// A date in words: year-month-day, and the time of day if asked for.
pub(super) fn date_label(day: f64, with_time: bool) -> String {
    // Seconds are as fine as labels go.
    let seconds = (day * 86_400.0).round() as i64;
    let (year, month, of_month) = civil(seconds.div_euclid(86_400));
    let date = format!("{year}-{month:02}-{of_month:02}");
    let rest = seconds.rem_euclid(86_400);
    match (with_time, rest % 60) {
        (false, _) => date,
        (true, 0) => format!("{date} {:02}:{:02}", rest / 3600, rest / 60 % 60),
        (true, second) => format!("{date} {:02}:{:02}:{second:02}", rest / 3600, rest / 60 % 60),
    }
}

/// Year, month and day of a day of the Gregorian calendar, counted from 1970-01-01.
///
/// # Source
/// H. Hinnant 2013, *chrono-compatible low-level date algorithms*: years begin in March, so that leap days end them.
fn civil(day: i64) -> (i64, i64, i64) {
    let shifted = day + 719_468;
    let (era, of_era) = (shifted.div_euclid(146_097), shifted.rem_euclid(146_097));
    let year = (of_era - of_era / 1_460 + of_era / 36_524 - of_era / 146_096) / 365;
    let of_year = of_era - (365 * year + year / 4 - year / 100);
    let month = (5 * of_year + 2) / 153;
    let of_month = of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    (year + era * 400 + i64::from(month <= 2), month, of_month)
}

/// The first day of a month.
fn day_of(year: i64, month: i64) -> i64 {
    let year = if month <= 2 { year - 1 } else { year };
    let of_year = (153 * (if month > 2 { month - 3 } else { month + 9 }) + 2) / 5;
    let (era, of_era) = (year.div_euclid(400), year.rem_euclid(400));
    era * 146_097 + of_era * 365 + of_era / 4 - of_era / 100 + of_year - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_and_dates_are_inverse() {
        assert_eq!(date_label(0.0, false), "1970-01-01");
        assert_eq!(date_label(11_016.0, false), "2000-02-29");
        assert_eq!(date_label(-0.5, true), "1969-12-31 12:00");
        for month in 0..4800 {
            let (year, month) = (1700 + month / 12, month % 12 + 1);
            assert_eq!(civil(day_of(year, month)), (year, month, 1));
            assert_eq!(civil(day_of(year, month) - 1).1, (month + 10) % 12 + 1);
        }
    }

    #[test]
    fn ticks_are_first_days_of_years_and_months() {
        let texts = |low, high| date_ticks(low, high, 8).into_iter().map(|(_, text)| text).collect::<Vec<_>>();
        assert_eq!(texts(10_595.0, 15_000.0), ["2000", "2002", "2004", "2006", "2008", "2010"]);
        assert_eq!(texts(10_595.0, 10_800.0), ["1999-02", "1999-03", "1999-04", "1999-05", "1999-06", "1999-07"]);
        assert_eq!(texts(0.0, 3.0), ["1970-01-01 00:00", "1970-01-01 12:00", "1970-01-02 00:00", "1970-01-02 12:00", "1970-01-03 00:00", "1970-01-03 12:00", "1970-01-04 00:00"]);
        assert_eq!(texts(0.25, 4.5), ["1970-01-02", "1970-01-03", "1970-01-04", "1970-01-05"]);
    }
}
