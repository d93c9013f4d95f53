"""The addresses of the project, which only the place knows where a release is built: its workflow's repository."""

from __future__ import annotations

import os
from typing import Any

from hatchling.metadata.plugin.interface import MetadataHookInterface


class Addresses(MetadataHookInterface):
    """Sets `project.urls` in a workflow of a repository; a wheel that is built elsewhere names none."""

    def update(self, metadata: dict[str, Any]) -> None:
        """Add the addresses of the source, the documentation, the changes and the issues to the project's table."""
        if repository := os.environ.get("GITHUB_REPOSITORY"):
            home = f"{os.environ.get('GITHUB_SERVER_URL', 'https://github.com')}/{repository}"
            metadata["urls"] = {
                "Source": home,
                "Documentation": f"{home}/tree/HEAD/docs",
                "Changelog": f"{home}/blob/HEAD/CHANGELOG.md",
                "Issues": f"{home}/issues",
            }
