//! What threads tell each other: the best plan so far.

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::Sender;
use std::sync::{Mutex, PoisonError};

use crate::epoch::search::Found;

/// The best plan of all threads, and the way of new ones to whoever collects them.
pub(super) struct Exchange {
    /// How many plans came in; tells the others that there is something to look at.
    version: AtomicU64,
    best: Mutex<Option<Found>>,
    to_collector: Mutex<Sender<Found>>,
}

impl Exchange {
    /// No plan yet; new ones are also sent to `to_collector`.
    pub(super) fn new(to_collector: Sender<Found>) -> Self {
        Self {
            version: AtomicU64::new(0),
            best: Mutex::new(None),
            to_collector: Mutex::new(to_collector),
        }
    }

    /// Hands on a plan that is better than the thread's own and, as far as it knew, than all.
    pub(super) fn publish(&self, found: &Found, better: impl Fn(&Found) -> bool) {
        let mut best = self.best.lock().unwrap_or_else(PoisonError::into_inner);
        if !best.as_ref().is_none_or(better) {
            return;
        }
        *best = Some(found.clone());
        self.version.fetch_add(1, Ordering::Release);
        let sender = self
            .to_collector
            .lock()
            .unwrap_or_else(PoisonError::into_inner);
        // Nobody listens any more when the run is over.
        drop(sender.send(found.clone()));
    }

    /// The best plan if there is another one since the version that was `seen`.
    pub(super) fn newer(&self, seen: &mut u64) -> Option<Found> {
        let version = self.version.load(Ordering::Acquire);
        if version == *seen {
            return None;
        }
        *seen = version;
        self.best
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }
}

#[cfg(test)]
mod tests {
    use std::sync::mpsc::channel;

    use super::{Exchange, Found};

    fn found(cost: f64) -> Found {
        Found {
            steps: Vec::new(),
            cost,
        }
    }

    #[test]
    fn only_better_plans_are_handed_on_and_seen_once() {
        let (sender, receiver) = channel();
        let exchange = Exchange::new(sender);
        let mut seen = 0;
        assert!(exchange.newer(&mut seen).is_none());
        for cost in [5.0, 7.0, 3.0] {
            exchange.publish(&found(cost), |best| cost < best.cost);
        }
        assert_eq!(exchange.newer(&mut seen).map(|best| best.cost), Some(3.0));
        assert!(exchange.newer(&mut seen).is_none());
        let told: Vec<f64> = receiver.try_iter().map(|each| each.cost).collect();
        assert_eq!(told, [5.0, 3.0]);
    }
}
