//! What `route` says: the order of a plan's postures, and the moves between them.

use super::postures::{posture_table, route_section};
use crate::summary::{Context, Summarise, Summary, Text, counted};
use stiffarm::Result;
use stiffarm::ask::route::{DriveOptions, Routed};
use stiffarm::findings::codes;
use stiffarm::model::posture::PostureGroup;

impl Summarise<DriveOptions> for Routed {
    fn summary(&self, options: &DriveOptions, context: &Context<'_>) -> Result<Summary> {
        let (posture_names, route) = (&self.posture_names, &self.route);
        let count = counted(route.postures.len(), "posture");
        let keep_order = options.keep_order;
        let what_was_done = Text::new(if keep_order {
            format!("The moves between {count} were looked at in the order given.")
        } else {
            format!("The order of {count} was chosen for the least turning or time.")
        });
        let blocked = route.moves.iter().filter(|one| !one.free).count();
        let moves = counted(route.moves.len(), "move");
        let is_forbidden = self.findings.iter().any(|f| f.code == codes::POSTURE_FORBIDDEN);
        let conclusion = match blocked {
            _ if route.moves.is_empty() => Text::new("A single posture: there is nothing to order."),
            0 if route.checked.is_empty() => Text::new(format!("{moves}, not checked against anything.")),
            0 if is_forbidden => Text::default()
                .strong("Not every posture is allowed")
                .words(format!("; the {moves} between them are free.")),
            0 => Text::new(format!("{moves}, every one of them free.")),
            count => Text::default().strong("No free way was found").words(format!(" for {count} of {moves}.")),
        };
        let next_step = match blocked {
            0 if is_forbidden => Text::new("Do not drive there as they are: ")
                .code("stiffarm select --initial")
                .words(" moves the postures inside the limits of the cell."),
            0 => Text::new("Write the postures in this order with ")
                .code("--output plan.csv")
                .words(", and the robot's program with ")
                .code("stiffarm export")
                .words("."),
            _ => Text::new("Teach a way of your own for the moves that are not free, or move what is in the way."),
        };
        let key = posture_table("The postures in this order, controller angles", posture_names, &route.postures, &[]);
        let mut sections = Vec::new();
        sections.extend(route_section(context, posture_names, route, &self.findings));
        let group = PostureGroup::named("route", posture_names, route.postures.iter().cloned());
        sections.push(context.cell_section(&[group], "Step through the postures in this order.")?);
        let heading = "Order of the postures and moves between them";
        Ok(context.summary(self.findings.clone(), heading, [what_was_done, conclusion, next_step], Some(key), sections))
    }
}
