//! What takes long is worked out on a thread of its own; meanwhile the last answer stays.

use pickglass::job::Job;

use crate::window::task::{Outcome, Task};

/// An answer to the latest question of one kind.
pub struct Later<K, T> {
    known: Option<(K, T)>,
    under_way: Option<(K, Job, Task<T>)>,
}

impl<K, T> Default for Later<K, T> {
    fn default() -> Self {
        Self {
            known: None,
            under_way: None,
        }
    }
}

impl<K: PartialEq + Clone, T: Send + 'static> Later<K, T> {
    /// Asks `question`, to be worked out by `work`, unless that is known or under way;
    /// another question that is under way is given up.
    pub fn ask(
        &mut self,
        ctx: &egui::Context,
        question: &K,
        work: impl FnOnce(&Job) -> T + Send + 'static,
    ) {
        if let Some((asked, _, task)) = &self.under_way {
            match task.poll() {
                Outcome::Working => {}
                Outcome::Ready(answer) => {
                    self.known = Some((asked.clone(), answer));
                    self.under_way = None;
                }
                Outcome::Lost => self.under_way = None,
            }
        }
        let known = self
            .known
            .as_ref()
            .is_some_and(|(asked, _)| asked == question);
        let coming = self
            .under_way
            .as_ref()
            .is_some_and(|(asked, ..)| asked == question);
        if known || coming {
            return;
        }
        if let Some((_, job, _)) = self.under_way.take() {
            job.cancel();
        }
        let job = Job::new();
        let token = job.clone();
        if let Ok(task) = Task::start(ctx, "pane", move || work(&token)) {
            self.under_way = Some((question.clone(), job, task));
        }
    }

    /// The last answer.
    pub fn answer(&self) -> Option<&T> {
        self.known.as_ref().map(|(_, answer)| answer)
    }

    /// The question that [`Self::answer`] answers.
    pub fn question(&self) -> Option<&K> {
        self.known.as_ref().map(|(question, _)| question)
    }

    /// Whether a newer answer is being worked out.
    pub fn is_working(&self) -> bool {
        self.under_way.is_some()
    }
}

impl<K, T> Drop for Later<K, T> {
    fn drop(&mut self) {
        if let Some((_, job, _)) = &self.under_way {
            job.cancel();
        }
    }
}
