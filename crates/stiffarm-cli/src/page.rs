//! `--report FILE`: the page of a result that was just made.

#[cfg(feature = "report")]
use crate::files::only_target;
use crate::files::{Target, write_all};
use crate::session::Session;
use serde::Serialize;
use std::cell::RefCell;
use stiffarm::Result;
use stiffarm::model::cell::Cell;

/// Where the page goes, and the cell as its file describes it: `stiffarm report` makes the same page later.
#[derive(Default)]
pub struct ResultPage {
    target: RefCell<Option<Target>>,
    cell: RefCell<Option<Cell>>,
}

impl ResultPage {
    /// Remembers the cell where a page is asked for.
    pub fn remember(&self, cell: &Cell) {
        if self.target.borrow().is_some() {
            self.cell.borrow_mut().get_or_insert_with(|| cell.clone());
        }
    }
}

impl Session {
    /// Remembers where the page of the result goes, if anywhere.
    ///
    /// # Errors
    /// A file that cannot be written, or exists and `force` is not given.
    pub fn will_report(&self, path: Option<&str>, force: bool) -> Result<()> {
        #[cfg(feature = "report")]
        if let Some(target) = only_target(self, path, force)? {
            self.page.target.replace(Some(target));
        }
        #[cfg(not(feature = "report"))]
        let _ = (path, force);
        Ok(())
    }

    /// Writes the page of a result, where one is asked for.
    ///
    /// # Errors
    /// A result that has no page.
    pub fn write_page(&self, envelope: &impl Serialize) -> Result<()> {
        let Some(target) = self.page.target.borrow_mut().take() else {
            return Ok(());
        };
        let cell = self.page.cell.borrow();
        match self.page_of(envelope, cell.as_ref())? {
            Some(page) => write_all(self, &[(target, page)]),
            None => Ok(()),
        }
    }

    /// The page of a result; `None` in a program without pages.
    ///
    /// # Errors
    /// A result that has no page.
    pub fn page_of(
        &self,
        envelope: &impl Serialize,
        cell: Option<&Cell>,
    ) -> Result<Option<String>> {
        #[cfg(feature = "report")]
        {
            use stiffarm::files::result::SavedResult;
            use stiffarm_report::page::render_page;
            use stiffarm_report::report::{Given, report};
            let saved = SavedResult::of(envelope, "result")?;
            let page = report(&[Given {
                saved: &saved,
                cell,
            }])?;
            Ok(Some(render_page(&page)))
        }
        #[cfg(not(feature = "report"))]
        {
            let _ = (envelope, cell);
            Ok(None)
        }
    }
}
