use super::*;
use crate::evolve::test_support::with_task;
use glam::DVec2;
use mindgap_core::controller::When;

const TUPLE: Tuple = Tuple { left: 40, right: 50, when: When::Larger, threshold_cm: 60 };

fn beginning(left: i8) -> Beginning {
    Beginning { tuples: vec![Tuple { left, ..TUPLE }, TUPLE], from: (1, 2, 3, 4) }
}

fn stop(scatter_cm: f64, reached: f64) -> Stop {
    Stop {
        tuple: TUPLE,
        place_cm: DVec2::new(100.0, 50.0),
        heading_rad: 0.1,
        scatter_cm,
        heading_scatter_rad: 0.0,
        lost: 0.0,
        reached,
        nearness: 0.0,
    }
}

/// The first commands of the elites but the start.
fn elites(archive: &Archive) -> Vec<i8> {
    archive.elites[1..].iter().map(|elite| elite.beginning.tuples[0].left).collect()
}

#[test]
fn a_cell_keeps_what_leads_there_with_the_least_scatter() {
    with_task(|task| {
        let mut archive = Archive::new(task);
        for (left, scatter_cm) in [(1, 9.0), (2, 5.0), (3, 7.0)] {
            archive.learn(&beginning(left), &stop(scatter_cm, 0.0));
        }
        assert_eq!(elites(&archive), [2]);
        // Elsewhere, in another heading, and by more tuples.
        archive.learn(&beginning(4), &Stop { place_cm: DVec2::new(100.0, 90.0), ..stop(9.0, 0.0) });
        archive.learn(&beginning(5), &Stop { heading_rad: -0.1, ..stop(9.0, 0.0) });
        let longer = Beginning { tuples: vec![Tuple { left: 6, ..TUPLE }; 3], from: (2, 2, 3, 4) };
        archive.learn(&longer, &stop(9.0, 0.0));
        assert_eq!(elites(&archive), [2, 4, 5, 6]);
    });
}

/// Nothing can be added to six tuples, and to what loses too many of its runs nothing is worth adding.
#[test]
fn what_nothing_can_follow_is_no_elite() {
    with_task(|task| {
        let mut archive = Archive::new(task);
        archive.learn(&Beginning { tuples: vec![TUPLE; 6], from: (5, 2, 3, 4) }, &stop(1.0, 1.0));
        archive.learn(&beginning(1), &Stop { lost: 0.5, ..stop(1.0, 0.5) });
        assert!(elites(&archive).is_empty());
        assert_eq!(archive.foremost().iter().map(|found| found.tuples.len()).collect::<Vec<_>>(), [6, 2]);
    });
}

#[test]
fn the_best_of_each_place_where_a_last_tuple_begins_is_a_candidate() {
    with_task(|task| {
        let mut archive = Archive::new(task);
        for (left, reached) in [(1, 0.2), (2, 0.8), (3, 0.5)] {
            archive.learn(&beginning(left), &stop(1.0, reached));
        }
        let foremost = archive.foremost();
        assert_eq!(foremost.iter().map(|found| found.tuples[0].left).collect::<Vec<_>>(), [2]);
    });
}

/// From the start one tuple is tried; the same seed tries the same.
#[test]
fn a_search_begins_with_single_tuples_and_repeats() {
    with_task(|task| {
        let tried = |seed| Archive::new(task).beginnings(&mut generator(seed, &[]));
        let tuples = |tried: Vec<Beginning>| tried.into_iter().map(|beginning| beginning.tuples).collect::<Vec<_>>();
        let first = tuples(tried(3));
        assert!(first.len() == TRIED && first.iter().all(|tuples| tuples.len() == 1));
        assert!(first == tuples(tried(3)) && first != tuples(tried(4)));
    });
}
