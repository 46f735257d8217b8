"""Planning requests are repeated under an idempotency key."""

import sqlalchemy as sa
from alembic import op

revision = "0003"
down_revision = "0002"
branch_labels = None
depends_on = None


def upgrade() -> None:
    """Adds the key and what tells a repetition from another request under it."""
    with op.batch_alter_table("plan_requests") as table:
        table.add_column(sa.Column("idempotency_key", sa.String(200)))
        table.add_column(sa.Column("body_digest", sa.String(64)))
        table.create_unique_constraint("one_request_a_key", ["client", "idempotency_key"])


def downgrade() -> None:
    """Drops the keys."""
    with op.batch_alter_table("plan_requests") as table:
        table.drop_constraint("one_request_a_key", type_="unique")
        table.drop_column("body_digest")
        table.drop_column("idempotency_key")
