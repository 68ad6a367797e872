"""The node that brings several objects to their goals by the action for one."""
